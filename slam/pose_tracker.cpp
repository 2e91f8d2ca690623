#include "slam/pose_tracker.hpp"

#include <algorithm>
#include <array>
#include <mutex>

namespace depthscope::slam {

PoseTracker::PoseTracker(const CameraModel& camera, const SlamSettings& settings, Map& map)
    : settings_(settings),
      camera_(camera),
      intrinsics_{camera.fx, camera.fy, camera.cx, camera.cy},
      map_(map),
      local_map_(settings),
      matcher_(settings.matching, settings.extractor.capacity()) {
  const int n = settings.extractor.capacity();
  projected_.reserve(settings.capacity.local_points);
  visible_.reserve(settings.capacity.local_points);
  last_points_.reserve(n);
  observations_.reserve(n);
  feature_of_observation_.reserve(n);
  point_of_observation_.reserve(n);
  matches_.resize(n);
  position_.resize(n);
  weight_.resize(n);
  wanted_.resize(n);
}

int PoseTracker::trackLastFrame(const TrackedFrame& last, TrackedFrame& frame) {
  const double radius = settings_.matching.motion_radius_px;
  const int enough = 2 * settings_.tracker.min_motion_inliers;
  int matched = matchLastFrame(last, radius, frame);
  if (matched < enough) matched = matchLastFrame(last, 2 * radius, frame);
  return matched < enough ? 0 : optimize(frame);
}

int PoseTracker::matchLastFrame(const TrackedFrame& last, double radius_px, TrackedFrame& frame) {
  projectLastFrame(last, radius_px, frame.T_camera_world, frame.twist);
  std::fill(matches_.begin(), matches_.end(), kNone);
  const int matched = matcher_.matchProjected(frame.features, projected_,
                                              settings_.matching.hamming_loose, 1.0, matches_);
  for (int f = 0; f < frame.features.size(); ++f) {
    frame.points[f] = {};
    if (matches_[f] < 0) continue;
    const LocalPoint& p = last_points_[projected_[matches_[f]].source];
    frame.points[f] = p.ref;
    position_[f] = p.position;
    weight_[f] = p.weight;
  }
  return matched;
}

void PoseTracker::projectLastFrame(const TrackedFrame& last, double radius_px,
                                   const Pose& T_camera_world, const Twist& twist) {
  last_points_.clear();
  projected_.clear();
  const std::lock_guard lock(map_.mutex);
  for (int f = 0; f < last.features.size(); ++f) {
    const PointId id = map_.resolve(last.points[f]);
    if (id == kNone) continue;
    const Eigen::Vector3d p = T_camera_world * map_.point(id).position;
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector2f px = map_.shutter().atItsRow(p, twist).cast<float>();
    const int octave = last.features.keypoints[f].octave;
    projected_.push_back({last.features.descriptors[f], px.x(), px.y(),
                          static_cast<float>(radius_px) * map_.scaleOf(octave), octave - 1,
                          octave + 1, static_cast<std::int32_t>(last_points_.size())});
    last_points_.push_back(makeLocalPoint(map_, id));
  }
}

int PoseTracker::trackKeyframe(KeyframeId keyframe, TrackedFrame& frame) {
  constexpr int kMinMatches = 15;
  constexpr double kRatio = 0.7;  // no pose guides this search: only matches that stand out
  {
    const std::lock_guard lock(map_.mutex);
    const Keyframe& k = map_.keyframe(keyframe);
    if (!k.alive) return 0;
    for (int f = 0; f < k.features.size(); ++f) wanted_[f] = k.points[f] != kNone;
    const int matched = matcher_.matchByDescriptor(
        k.features, wanted_, frame.features, settings_.matching.hamming_strict, kRatio, matches_);
    if (matched < kMinMatches) return 0;
    std::fill(frame.points.begin(), frame.points.end(), PointRef{});
    for (int f = 0; f < k.features.size(); ++f)
      if (matches_[f] >= 0) frame.points[matches_[f]] = map_.ref(k.points[f]);
    lookUpPoints(frame);
  }
  return optimize(frame);
}

int PoseTracker::trackOwnPoints(TrackedFrame& frame) {
  {
    const std::lock_guard lock(map_.mutex);
    lookUpPoints(frame);
  }
  return optimize(frame);
}

int PoseTracker::trackLocalMap(TrackedFrame& frame, double search_scale) {
  {
    const std::lock_guard lock(map_.mutex);
    local_map_.collect(map_, frame.points);
    lookUpPoints(frame);
  }
  projectLocalMap(frame.T_camera_world, frame.twist, search_scale);
  for (int f = 0; f < frame.features.size(); ++f)
    matches_[f] = frame.points[f].id == kNone ? kNone : kTaken;
  matcher_.matchProjected(frame.features, projected_, settings_.matching.hamming_loose,
                          settings_.matching.ratio, matches_);
  for (int f = 0; f < frame.features.size(); ++f) {
    if (matches_[f] < 0) continue;
    const LocalPoint& p = local_map_.points()[projected_[matches_[f]].source];
    frame.points[f] = p.ref;
    position_[f] = p.position;
    weight_[f] = p.weight;
  }
  const int inliers = optimize(frame);
  countSightings(frame);
  if (inliers > 0) rememberResiduals(frame.T_camera_world);
  return inliers;
}

void PoseTracker::projectLocalMap(const Pose& T, const Twist& twist, double search_scale,
                                  bool all) {
  constexpr double kNearlyFrontalCos = 0.998;  // a narrower window is enough then
  constexpr double kMaxViewAngleCos = 0.5;     // 60 degrees from the mean viewing direction
  projected_.clear();
  visible_.clear();
  const Eigen::Matrix3d R_world_camera = T.R.transpose();
  const auto points = local_map_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LocalPoint& lp = points[i];
    const Eigen::Vector3d p = T * lp.position;
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector2d px = camera_.project(p);
    if (px.x() < 0 || px.y() < 0 || px.x() > camera_.width - 1 || px.y() > camera_.height - 1)
      continue;
    const double distance = p.norm();
    if (distance < 0.8 * lp.min_distance || distance > 1.2 * lp.max_distance) continue;
    const double cos_view = (R_world_camera * p).dot(lp.normal.cast<double>()) / distance;
    if (cos_view < kMaxViewAngleCos) continue;
    visible_.push_back(lp.ref);
    if (lp.tracked && !all) continue;
    const Eigen::Vector2f undistorted = map_.shutter().atItsRow(p, twist).cast<float>();
    const int level = map_.predictLevel(lp.max_distance, distance);
    const double radius = settings_.matching.map_radius_px * search_scale *
                          (cos_view > kNearlyFrontalCos ? 0.625 : 1.0);
    projected_.push_back({lp.descriptor, undistorted.x(), undistorted.y(),
                          static_cast<float>(radius) * map_.scaleOf(level), level - 1, level,
                          static_cast<std::int32_t>(i)});
  }
}

int PoseTracker::foundByChance(const TrackedFrame& frame) {
  // Beyond the windows that points are looked for in, near enough to see tissue of the same kind.
  const float beside = static_cast<float>(camera_.width) / 16;
  const std::array<Eigen::Vector2f, 4> places{
      Eigen::Vector2f(beside, 0), {-beside, 0}, {0, beside}, {0, -beside}};
  projectLocalMap(frame.T_camera_world, frame.twist, 1, true);
  int found = 0;
  Eigen::Vector2f moved = Eigen::Vector2f::Zero();
  for (const Eigen::Vector2f& place : places) {
    for (ProjectedPoint& p : projected_) {
      p.u += place.x() - moved.x();
      p.v += place.y() - moved.y();
    }
    moved = place;
    std::fill(matches_.begin(), matches_.end(), kNone);
    matcher_.matchProjected(frame.features, projected_, settings_.matching.hamming_loose,
                            settings_.matching.ratio, matches_);
    for (int f = 0; f < frame.features.size(); ++f) {
      if (matches_[f] < 0) continue;
      const Keypoint& k = frame.features.keypoints[f];
      const float du = projected_[matches_[f]].u - k.ux, dv = projected_[matches_[f]].v - k.uy;
      found += du * du + dv * dv <= kChi2TwoDof95 * k.sigma * k.sigma;
    }
  }
  return found / static_cast<int>(places.size());
}

void PoseTracker::lookUpPoints(TrackedFrame& frame) {
  for (int f = 0; f < frame.features.size(); ++f) {
    const PointId p = map_.resolve(frame.points[f]);
    if (p == kNone) {
      frame.points[f] = {};
      continue;
    }
    position_[f] = map_.point(p).position;
    weight_[f] = map_.point(p).poseWeight();
  }
}

int PoseTracker::optimize(TrackedFrame& frame) {
  observations_.clear();
  feature_of_observation_.clear();
  point_of_observation_.clear();
  for (int f = 0; f < frame.features.size(); ++f) {
    if (frame.points[f].id == kNone) continue;
    const Keypoint& k = frame.features.keypoints[f];
    observations_.push_back(
        {position_[f],
         map_.shutter().atMiddleRow(k, frame.twist, frame.T_camera_world * position_[f]),
         1 / (k.sigma * k.sigma), weight_[f], true});
    feature_of_observation_.push_back(f);
    point_of_observation_.push_back(frame.points[f]);
  }
  shareWeights();
  const PoseOptimizerResult result = optimizePose(intrinsics_, observations_, frame.T_camera_world);
  if (!result.ok) return 0;
  // Two residuals a point, which the optimizer takes to be of unit variance.
  frame.covariance = result.covariance * (result.rms_px * result.rms_px / 2);
  frame.depth = 0;
  for (const PoseObservation& o : observations_)
    if (o.inlier) frame.depth += (frame.T_camera_world * o.point_world).z() / result.inliers;
  for (std::size_t i = 0; i < observations_.size(); ++i)
    if (!observations_[i].inlier) frame.points[feature_of_observation_[i]] = {};
  return result.inliers;
}

/// Weights are relative: together the observations say as much as equal ones of their effective
/// number would (Kish 1965), which is what the covariance of the pose rests on.
void PoseTracker::shareWeights() {
  double sum = 0, squares = 0;
  for (const PoseObservation& o : observations_) {
    sum += o.weight;
    squares += o.weight * o.weight;
  }
  for (PoseObservation& o : observations_) o.weight *= sum / squares;
}

void PoseTracker::countSightings(const TrackedFrame& frame) {
  const std::lock_guard lock(map_.mutex);
  for (const PointRef& r : visible_)
    if (const PointId p = map_.resolve(r); p != kNone) ++map_.point(p).visible;
  for (int f = 0; f < frame.features.size(); ++f)
    if (const PointId p = map_.resolve(frame.points[f]); p != kNone) ++map_.point(p).found;
}

/// Of inliers and outliers alike: what moves is mostly among the latter.
void PoseTracker::rememberResiduals(const Pose& T_camera_world) {
  constexpr double kForgotten = 1.0 / 16;      // of the past with each frame: half a second is kept
  constexpr double kMost = 4 * kChi2TwoDof95;  // farther off it was another point that looks alike
  const std::lock_guard lock(map_.mutex);
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const PointId id = map_.resolve(point_of_observation_[i]);
    const Eigen::Vector3d p = T_camera_world * observations_[i].point_world;
    if (id == kNone || p.z() < kMinDepth) continue;
    const double chi2 = (intrinsics_.project(p) - observations_[i].pixel).squaredNorm() *
                        observations_[i].inv_sigma2;
    if (chi2 > kMost) continue;
    float& residual = map_.point(id).residual;
    residual += static_cast<float>(kForgotten * (chi2 - residual));
  }
}

}  // namespace depthscope::slam
