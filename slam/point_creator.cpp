#include "slam/point_creator.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "slam/triangulation.hpp"

namespace depthscope::slam {

namespace {
constexpr double kRadiansPerDegree = std::numbers::pi / 180;
}  // namespace

/// Two keyframes and the geometry between them.
struct PointCreator::Pair {
  const Keyframe& a;
  const Keyframe& b;
  Pose T_b_a;
  Eigen::Matrix3d F;  // x_b^T F x_a = 0 for homogeneous undistorted pixels
};

PointCreator::PointCreator(const SlamSettings& settings, Map& map)
    : matching_(settings.matching),
      settings_(settings.mapper),
      scale_factor_(settings.extractor.scale_factor),
      max_parallax_cos_(std::cos(settings.mapper.min_parallax_deg * kRadiansPerDegree)),
      expected_parallax_(settings.mapper.expected_parallax_deg * kRadiansPerDegree),
      map_(map) {
  const std::size_t n = settings.extractor.capacity();
  pixels_a_.reserve(n);
  pixels_b_.reserve(n);
  free_.reserve(n);
  match_.resize(n);
  claimed_by_.resize(n);
  claimed_distance_.resize(n);
  depths_.reserve(n);
}

void PointCreator::create(KeyframeId keyframe, std::span<const KeyframeId> neighbours,
                          std::vector<PointRef>& created) {
  const DepthRange depths = depthRange(keyframe);
  if (depths.farthest <= 0) return;
  for (const KeyframeId n : neighbours) createWith(keyframe, n, depths, created);
}

PointCreator::DepthRange PointCreator::depthRange(KeyframeId keyframe) {
  const Keyframe& k = map_.keyframe(keyframe);
  depths_.clear();
  for (const PointId p : k.points)
    if (p != kNone) depths_.push_back((k.T_camera_world * map_.point(p).position).z());
  if (depths_.size() < 10) return {0, 0, 0};
  std::sort(depths_.begin(), depths_.end());
  // What is not mapped yet may well lie before or behind what is.
  return {0.4 * depths_[depths_.size() / 20], depths_[depths_.size() / 2],
          2.5 * depths_[depths_.size() - 1 - depths_.size() / 20]};
}

void PointCreator::createWith(KeyframeId keyframe, KeyframeId neighbour, DepthRange depths,
                              std::vector<PointRef>& created) {
  const Keyframe& a = map_.keyframe(keyframe);
  const Keyframe& b = map_.keyframe(neighbour);
  const Pose T_b_a = b.T_camera_world * a.T_camera_world.inverse();
  if (T_b_a.t.norm() < expected_parallax_ * depths.middle) return;  // for no feature enough

  const Intrinsics& c = map_.intrinsics();
  Eigen::Matrix3d K_inv;
  K_inv << 1 / c.fx, 0, -c.cx / c.fx, 0, 1 / c.fy, -c.cy / c.fy, 0, 0, 1;
  toMiddleRow(keyframe, depths.middle, pixels_a_);
  toMiddleRow(neighbour, depths.middle, pixels_b_);
  const Pair pair{a, b, T_b_a, K_inv.transpose() * skew(T_b_a.t) * T_b_a.R * K_inv};
  matchAlongEpipolarLines(pair, depths);

  for (int i = 0; i < a.features.size(); ++i) {
    Eigen::Vector3d world;
    if (match_[i] == kNone || !accept(pair, i, match_[i], world)) continue;
    const std::lock_guard lock(map_.mutex);
    if (created.size() == created.capacity()) return;
    const PointId p = map_.addPoint(world, a.serial);
    if (p == kNone) return;
    map_.observe(p, keyframe, i);
    map_.observe(p, neighbour, match_[i]);
    map_.refreshPoint(p);
    created.push_back(map_.ref(p));
  }
}

/// Where the features of a keyframe would be seen if all rows were exposed with the middle one,
/// were they at `depth`.
void PointCreator::toMiddleRow(KeyframeId keyframe, double depth,
                               std::vector<Eigen::Vector2d>& pixels) {
  const Twist twist = map_.twistOf(keyframe);
  pixels.clear();
  for (const Keypoint& k : map_.keyframe(keyframe).features.keypoints) {
    const Eigen::Vector3d ray = map_.intrinsics().normalize({k.ux, k.uy}).homogeneous();
    pixels.push_back(map_.shutter().atMiddleRow(k, twist, depth * ray));
  }
}

void PointCreator::matchAlongEpipolarLines(const Pair& pair, DepthRange depths) {
  const auto& [a, b, T_b_a, F] = pair;
  free_.clear();
  for (int j = 0; j < b.features.size(); ++j) {
    if (b.points[j] != kNone) continue;
    const Keypoint& k = b.features.keypoints[j];
    const Eigen::Vector2f px = pixels_b_[j].cast<float>();
    free_.push_back({px.x(), px.y(), static_cast<float>(kChi2OneDof95) * k.sigma * k.sigma, j});
  }
  std::fill(claimed_by_.begin(), claimed_by_.end(), kNone);
  std::fill(match_.begin(), match_.end(), kNone);
  const Intrinsics& camera = map_.intrinsics();
  const Eigen::Vector3d centre_b = -(T_b_a.R.transpose() * T_b_a.t);  // in camera a

  for (int i = 0; i < a.features.size(); ++i) {
    if (a.points[i] != kNone) continue;
    const Eigen::Vector2d& px = pixels_a_[i];
    const Eigen::Vector3d ray = camera.normalize(px).homogeneous();
    // The baseline across the ray over the distance along it.
    if (centre_b.cross(ray).norm() < expected_parallax_ * depths.middle * ray.squaredNorm())
      continue;
    const Eigen::Vector3d line = F * px.homogeneous();
    const float inv_norm = static_cast<float>(1 / line.head<2>().norm());
    const float la = static_cast<float>(line.x()) * inv_norm,
                lb = static_cast<float>(line.y()) * inv_norm,
                lc = static_cast<float>(line.z()) * inv_norm;
    // The stretch of the line on which depths between nearest and farthest project.
    const Eigen::Vector3d p_near = T_b_a * (ray * depths.nearest),
                          p_far = T_b_a * (ray * depths.farthest);
    if (p_near.z() < kMinDepth || p_far.z() < kMinDepth) continue;
    const float s0 = static_cast<float>(Eigen::Vector2d(-lb, la).dot(camera.project(p_near)));
    const float s1 = static_cast<float>(Eigen::Vector2d(-lb, la).dot(camera.project(p_far)));
    const float from = std::min(s0, s1) - 3, to = std::max(s0, s1) + 3;

    int best = kNone, best_distance = matching_.hamming_strict + 1;
    for (const Free& f : free_) {
      const float d = la * f.u + lb * f.v + lc;
      const float s = -lb * f.u + la * f.v;
      if (d * d > f.gate || s < from || s > to) continue;
      const int hamming =
          hammingDistance(a.features.descriptors[i], b.features.descriptors[f.feature]);
      if (hamming >= best_distance) continue;
      best = f.feature;
      best_distance = hamming;
    }
    if (best == kNone) continue;
    if (const int other = claimed_by_[best]; other != kNone) {
      if (claimed_distance_[best] <= best_distance) continue;
      match_[other] = kNone;
    }
    match_[i] = best;
    claimed_by_[best] = i;
    claimed_distance_[best] = best_distance;
  }
}

bool PointCreator::accept(const Pair& pair, int feature_a, int feature_b,
                          Eigen::Vector3d& world) const {
  const auto& [a, b, T_b_a, F] = pair;
  const Keypoint& ka = a.features.keypoints[feature_a];
  const Keypoint& kb = b.features.keypoints[feature_b];
  const Intrinsics& c = map_.intrinsics();
  const Eigen::Vector2d &ua = pixels_a_[feature_a], &ub = pixels_b_[feature_b];
  const Eigen::Vector2d na = c.normalize(ua), nb = c.normalize(ub);
  if (rayParallaxCosine(a.T_camera_world, na, b.T_camera_world, nb) > max_parallax_cos_)
    return false;
  if (!triangulate(a.T_camera_world, na, b.T_camera_world, nb, world)) return false;

  const Eigen::Vector3d pa = a.T_camera_world * world, pb = b.T_camera_world * world;
  const double ea = (c.project(pa) - ua).squaredNorm();
  const double eb = (c.project(pb) - ub).squaredNorm();
  if (ea > settings_.triangulation_chi2 * ka.sigma * ka.sigma) return false;
  if (eb > settings_.triangulation_chi2 * kb.sigma * kb.sigma) return false;

  // Seen from twice as far, a patch appears one octave of scale finer: both ratios must agree.
  const double by_distance = pb.norm() / pa.norm();
  const double by_octave = map_.scaleOf(ka.octave) / map_.scaleOf(kb.octave);
  const double tolerance = 1.5 * scale_factor_;
  return by_distance < by_octave * tolerance && by_octave < by_distance * tolerance;
}

}  // namespace depthscope::slam
