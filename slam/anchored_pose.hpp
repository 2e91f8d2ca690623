#pragma once
#include <span>

#include "slam/map.hpp"

namespace depthscope::slam {

/// Pose of a frame relative to a keyframe, so that it follows every later correction of the map.
/// Packed, for a day of them is kept: relative to a keyframe nearby single precision is a hundred
/// times finer than any pose is known.
struct AnchoredPose {
  std::int64_t frame = -1;
  double timestamp_s = 0;
  KeyframeId reference = kNone;  // kNone: forgotten
  float unit = 1;                // Keyframe::unit of the reference when this was recorded
  Eigen::Quaternion<float, Eigen::DontAlign> q_camera_reference;
  Eigen::Vector3f t_camera_reference = Eigen::Vector3f::Zero();

  /// Hangs the pose on a keyframe, in the unit of length of now.
  void anchor(const Map& map, KeyframeId keyframe, const Pose& T_camera_reference);
  /// In the unit of length of now.
  Pose T_camera_reference(const Map& map) const;
  Pose T_camera_world(const Map& map) const;
  bool inMap(const Map& map, std::uint32_t map_id) const {
    return reference != kNone && map.keyframe(reference).map_id == map_id;
  }
};

/// What hangs on keyframe `from` hangs on `to` afterwards; call before `from` is removed.
void rebase(std::span<AnchoredPose> poses, const Map& map, KeyframeId from, KeyframeId to);
/// Forgets what hangs on a keyframe.
void drop(std::span<AnchoredPose> poses, KeyframeId reference);

}  // namespace depthscope::slam
