#include "slam/relocalizer.hpp"

#include <algorithm>

namespace depthscope::slam {

namespace {
constexpr int kKeyframesPerFrame = 24;  // bounds the time spent on one lost frame
constexpr int kMinMatches = 15;
constexpr double kRatio = 0.8;
}  // namespace

Relocalizer::Relocalizer(const SlamSettings& settings, const CameraModel& camera)
    : settings_(settings.matching),
      camera_{camera.fx, camera.fy, camera.cx, camera.cy},
      matcher_(settings.matching, settings.extractor.features),
      pnp_(PnpSettings{}, settings.extractor.features) {
  const std::size_t n = settings.extractor.features;
  wanted_.resize(n);
  matches_.resize(n);
  observations_.reserve(n);
  feature_of_observation_.reserve(n);
  point_of_observation_.reserve(n);
}

bool Relocalizer::relocalize(const Map& map, const FeatureSet& features, Pose& T_camera_world,
                             std::span<PointRef> points) {
  int tried = 0;
  for (int i = 0; i < map.keyframeCapacity() && tried < kKeyframesPerFrame; ++i) {
    const KeyframeId k = next_ = (next_ + 1) % map.keyframeCapacity();
    if (!map.keyframe(k).alive) continue;
    ++tried;
    if (tryKeyframe(map, map.keyframe(k), features, T_camera_world, points)) {
      next_ = k - 1;  // start with the same one next time
      return true;
    }
  }
  return false;
}

bool Relocalizer::tryKeyframe(const Map& map, const Keyframe& keyframe, const FeatureSet& features,
                              Pose& T_camera_world, std::span<PointRef> points) {
  for (int f = 0; f < keyframe.features.size(); ++f) wanted_[f] = keyframe.points[f] != kNone;
  const int n = matcher_.matchByDescriptor(keyframe.features, wanted_, features,
                                           settings_.hamming_strict, kRatio, matches_);
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
