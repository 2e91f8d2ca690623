#include "slam/point_fuser.hpp"

#include <mutex>

namespace depthscope::slam {

namespace {
constexpr float kFuseRadiusPx = 3;        // at level 0
constexpr double kMaxViewAngleCos = 0.5;  // 60 degrees from the mean viewing direction
}  // namespace

PointFuser::PointFuser(const SlamSettings& settings, Map& map)
    : settings_(settings.matching), map_(map) {
  points_.reserve(settings.capacity.local_points);
  stamp_.resize(settings.capacity.map_points, 0);
  candidates_.resize(settings.extractor.capacity());
}

void PointFuser::fuse(KeyframeId keyframe, std::span<const KeyframeId> neighbours) {
  for (const KeyframeId n : neighbours) {
    const auto& own = map_.keyframe(keyframe).points;
    points_.assign(own.begin(), own.end());
    fuseInto(n, points_);
  }
  ++current_stamp_;
  points_.clear();
  for (const KeyframeId n : neighbours) {
    for (const PointId p : map_.keyframe(n).points) {
      if (p == kNone || stamp_[p] == current_stamp_ || points_.size() == points_.capacity())
        continue;
      stamp_[p] = current_stamp_;
      points_.push_back(p);
    }
  }
  fuseInto(keyframe, points_);
  const std::lock_guard lock(map_.mutex);
  for (const PointId p : map_.keyframe(keyframe).points)
    if (p != kNone) map_.refreshPoint(p);
}

void PointFuser::fuseInto(KeyframeId target, std::span<const PointId> points) {
  const Keyframe& k = map_.keyframe(target);
  const Twist twist = map_.twistOf(target);
  for (const PointId p : points) {
    if (p == kNone || !map_.point(p).alive || map_.isObservedBy(p, target)) continue;
    const int feature = findFeature(k, twist, map_.point(p));
    if (feature == kNone) continue;
    const std::lock_guard lock(map_.mutex);
    const PointId other = k.points[feature];
    if (other == kNone) {
      map_.observe(p, target, feature);
    } else if (map_.point(other).observation_count > map_.point(p).observation_count) {
      map_.mergePoints(p, other);
    } else {
      map_.mergePoints(other, p);
    }
  }
}

int PointFuser::findFeature(const Keyframe& target, const Twist& twist, const MapPoint& point) {
  const Eigen::Vector3d p = target.T_camera_world * point.position;
  if (p.z() < kMinDepth) return kNone;
  const double distance = p.norm();
  if (distance < 0.8 * point.min_distance || distance > 1.2 * point.max_distance) return kNone;
  const Eigen::Vector3d direction = target.T_camera_world.R.transpose() * p / distance;
  if (direction.dot(point.normal) < kMaxViewAngleCos) return kNone;

  const Eigen::Vector2d px = map_.shutter().atItsRow(p, twist);
  const int level = map_.predictLevel(point.max_distance, distance);
  const float radius = kFuseRadiusPx * map_.scaleOf(level);
  const int n = target.features.grid.query(static_cast<float>(px.x()), static_cast<float>(px.y()),
                                           radius, level - 1, level, candidates_);
  int best = kNone, best_distance = settings_.hamming_strict + 1;
  for (int c = 0; c < n; ++c) {
    const int f = static_cast<int>(candidates_[c]);
    const Keypoint& kp = target.features.keypoints[f];
    const double error = (px - Eigen::Vector2d(kp.ux, kp.uy)).squaredNorm();
    if (error > kChi2TwoDof95 * kp.sigma * kp.sigma) continue;
    const int d = hammingDistance(point.descriptor, target.features.descriptors[f]);
    if (d >= best_distance) continue;
    best = f;
    best_distance = d;
  }
  return best;
}

}  // namespace depthscope::slam
