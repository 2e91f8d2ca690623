#include "slam/relocalizer.hpp"

#include <algorithm>

namespace depthscope::slam {

namespace {
constexpr int kKeyframesPerFrame = 24;  // bounds the time spent on one lost frame
constexpr int kMinMatches = 15;
// Patches of tissue look much alike: over a whole picture the nearest descriptor is seldom clearly
// nearer than the second, so nothing is refused by ratio, and the consensus has to tell.
constexpr double kRatio = 1.0;
constexpr int kMaxHamming = 80;

/// A wrong match agrees with a pose by chance about once in 10,000 (area of the inlier window over
/// area of the picture), so that nine together are no chance; and the local map is asked as well.
PnpSettings pnpSettings() {
  PnpSettings s;
  s.ransac_iterations = 1500;
  s.min_inliers = 9;
  return s;
}
}  // namespace

Relocalizer::Relocalizer(const SlamSettings& settings, const CameraModel& camera)
    : camera_{camera.fx, camera.fy, camera.cx, camera.cy},
      matcher_(settings.matching, settings.extractor.features),
      pnp_(pnpSettings(), settings.extractor.features) {
  const std::size_t n = settings.extractor.features;
  wanted_.resize(n);
  matches_.resize(n);
  order_.reserve(settings.capacity.keyframes);
  observations_.reserve(n);
  feature_of_observation_.reserve(n);
  point_of_observation_.reserve(n);
}

bool Relocalizer::relocalize(const Map& map, const FeatureSet& features, Pose& T_camera_world,
                             std::span<PointRef> points) {
  // Newest first: a scope that was lost a moment ago has not gone far.
  order_.clear();
  for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k)
    if (map.keyframe(k).alive) order_.push_back(k);
  std::sort(order_.begin(), order_.end(), [&](KeyframeId a, KeyframeId b) {
    return map.keyframe(a).serial > map.keyframe(b).serial;
  });
  const std::size_t count = std::min<std::size_t>(order_.size(), kKeyframesPerFrame);
  for (std::size_t i = 0; i < count; ++i) {
    if (next_ >= order_.size()) next_ = 0;
    const Keyframe& keyframe = map.keyframe(order_[next_]);
    if (tryKeyframe(map, keyframe, features, T_camera_world, points)) return true;
    ++next_;
  }
  return false;
}

bool Relocalizer::tryKeyframe(const Map& map, const Keyframe& keyframe, const FeatureSet& features,
                              Pose& T_camera_world, std::span<PointRef> points) {
  for (int f = 0; f < keyframe.features.size(); ++f) wanted_[f] = keyframe.points[f] != kNone;
  const int n = matcher_.matchByDescriptor(keyframe.features, wanted_, features, kMaxHamming,
                                           kRatio, matches_);
  if (n < kMinMatches) return false;

  observations_.clear();
  feature_of_observation_.clear();
  point_of_observation_.clear();
  for (int f = 0; f < keyframe.features.size(); ++f) {
    if (matches_[f] < 0) continue;
    const Keypoint& k = features.keypoints[matches_[f]];
    const PointId p = keyframe.points[f];
    observations_.push_back(
        {map.point(p).position, {k.ux, k.uy}, 1 / (k.sigma * k.sigma), 1, true});
    feature_of_observation_.push_back(matches_[f]);
    point_of_observation_.push_back(map.ref(p));
  }
  PnpResult result;
  if (!pnp_.solve(camera_, observations_, result)) return false;
  T_camera_world = result.T_camera_world;
  std::fill(points.begin(), points.end(), PointRef{});
  for (std::size_t i = 0; i < observations_.size(); ++i)
    if (observations_[i].inlier) points[feature_of_observation_[i]] = point_of_observation_[i];
  return true;
}

}  // namespace depthscope::slam
