#include "slam/local_bundle.hpp"

#include <algorithm>
#include <mutex>

#include "slam/map_observation.hpp"

namespace depthscope::slam {

LocalBundle::LocalBundle(const SlamSettings& settings, Map& map, BundleAdjuster& adjuster)
    : map_(map), max_fixed_(settings.mapper.window_fixed), adjuster_(adjuster) {
  const int keyframes = settings.capacity.keyframes;
  pose_index_.resize(keyframes);
  twists_.resize(keyframes);
  shared_.resize(keyframes);
  keyframes_.reserve(keyframes);
  outside_.reserve(keyframes);
  points_.reserve(settings.capacity.local_points);
  stamp_.resize(settings.capacity.map_points, 0);
}

BaSummary LocalBundle::adjust(std::span<const KeyframeId> window, int iterations,
                              const std::atomic<bool>* stop) {
  gather(window);
  BaSettings settings;
  // First robustly, then without the outliers this shows (Mur-Artal et al. 2015, section VI.D).
  settings.max_iterations = iterations / 2;
  BaSummary summary = adjuster_.solve(map_.intrinsics(), settings, stop);
  if (summary.end != BaSummary::End::Failed && summary.end != BaSummary::End::Stopped) {
    settings.max_iterations = iterations - iterations / 2;
    summary = adjuster_.solve(map_.intrinsics(), settings, stop);
  }
  if (summary.end != BaSummary::End::Failed) writeBack();
  return summary;
}

void LocalBundle::gather(std::span<const KeyframeId> window) {
  adjuster_.clear();
  keyframes_.clear();
  std::fill(pose_index_.begin(), pose_index_.end(), kNone);
  for (const KeyframeId k : window) {
    pose_index_[k] = adjuster_.addPose(map_.keyframe(k).T_camera_world, false);
    keyframes_.push_back(k);
  }
  gatherPoints(window);
  chooseFixed();
  addObservations();
}

void LocalBundle::gatherPoints(std::span<const KeyframeId> window) {
  ++current_stamp_;
  points_.clear();
  std::fill(shared_.begin(), shared_.end(), 0);
  for (const KeyframeId k : window) {
    for (const PointId p : map_.keyframe(k).points) {
      if (p == kNone || stamp_[p] == current_stamp_) continue;
      if (adjuster_.addPoint(map_.point(p).position) < 0) return;
      stamp_[p] = current_stamp_;
      points_.push_back(p);
      for (const Observation& o : map_.observations(p)) ++shared_[o.keyframe];
    }
  }
}

void LocalBundle::chooseFixed() {
  outside_.clear();
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (shared_[k] > 0 && pose_index_[k] == kNone) outside_.push_back(k);
  const auto sees_more = [&](KeyframeId a, KeyframeId b) {
    return shared_[a] != shared_[b] ? shared_[a] > shared_[b] : a < b;
  };
  std::sort(outside_.begin(), outside_.end(), sees_more);
  outside_.resize(std::min<std::size_t>(outside_.size(), max_fixed_));
  for (const KeyframeId k : outside_) {
    pose_index_[k] = adjuster_.addPose(map_.keyframe(k).T_camera_world, true);
    keyframes_.push_back(k);
  }
  // Seven degrees of freedom are free in a monocular map: without two fixed keyframes the oldest of
  // the window hold it.
  std::size_t missing = 2 - std::min<std::size_t>(2, outside_.size());
  const std::size_t window = keyframes_.size() - outside_.size();
  for (; missing > 0 && missing < window; --missing) {
    std::size_t oldest = window;
    for (std::size_t i = 0; i < window; ++i) {
      if (adjuster_.poses()[i].fixed) continue;
      if (oldest == window ||
          map_.keyframe(keyframes_[i]).serial < map_.keyframe(keyframes_[oldest]).serial)
        oldest = i;
    }
    adjuster_.poses()[oldest].fixed = true;
  }
}

void LocalBundle::addObservations() {
  for (std::size_t i = 0; i < keyframes_.size(); ++i) twists_[i] = map_.twistOf(keyframes_[i]);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d& position = map_.point(points_[i]).position;
    const float trust = map_.trustOf(points_[i]);
    for (const Observation& o : map_.observations(points_[i])) {
      const int pose = pose_index_[o.keyframe];
      if (pose == kNone) continue;
      BaObservation added = mapObservation(map_.shutter(), map_.keyframe(o.keyframe), o.feature,
                                           twists_[pose], position, trust);
      added.pose = pose;
      added.point = static_cast<int>(i);
      adjuster_.addObservation(added);
    }
  }
}

void LocalBundle::writeBack() {
  const std::lock_guard lock(map_.mutex);
  for (std::size_t i = 0; i < keyframes_.size(); ++i)
    if (!adjuster_.poses()[i].fixed)
      map_.keyframe(keyframes_[i]).T_camera_world = adjuster_.poses()[i].T_camera_world;
  for (std::size_t i = 0; i < points_.size(); ++i)
    map_.point(points_[i]).position = adjuster_.points()[i];
  for (const BaObservation& o : adjuster_.observations())
    if (!o.inlier && map_.point(points_[o.point]).alive)
      map_.unobserve(points_[o.point], keyframes_[o.pose]);
  for (const PointId p : points_)
    if (map_.point(p).alive) map_.refreshGeometry(p);
}

}  // namespace depthscope::slam
