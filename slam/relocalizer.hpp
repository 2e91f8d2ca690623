#pragma once
#include <vector>

#include "slam/map.hpp"
#include "slam/matcher.hpp"
#include "slam/pnp.hpp"

namespace depthscope::slam {

/// Finds the camera in the map without knowing where it was: matches the picture's descriptors with
/// those of one keyframe after another, and solves for the pose by P3P in RANSAC (Mur-Artal et al.
/// 2015, section V.C).
class Relocalizer {
 public:
  Relocalizer(const SlamSettings& settings, const CameraModel& camera);

  /// Starts with the newest keyframe at the next call.
  void restart() { next_ = 0; }
  /// Tries a bounded number of keyframes, going on where the last call stopped. True with a pose,
  /// and in `points` (one per feature) the map points it rests on. The caller verifies it against
  /// the local map. Map mutex held.
  bool relocalize(const Map& map, const FeatureSet& features, Pose& T_camera_world,
                  std::span<PointRef> points);

 private:
  bool tryKeyframe(const Map& map, const Keyframe& keyframe, const FeatureSet& features,
                   Pose& T_camera_world, std::span<PointRef> points);

  Intrinsics camera_;
  Matcher matcher_;
  PnpSolver pnp_;
  std::vector<std::uint8_t> wanted_;  // per keyframe feature: sees a point
  std::vector<int> matches_;          // per keyframe feature
  std::vector<PoseObservation> observations_;
  std::vector<int> feature_of_observation_;
  std::vector<PointRef> point_of_observation_;
  std::vector<KeyframeId> order_;  // in which keyframes are tried
  std::size_t next_ = 0;           // in order_
};

}  // namespace depthscope::slam
