#include "slam/anchored_pose.hpp"

namespace depthscope::slam {

void AnchoredPose::anchor(const Map& map, KeyframeId keyframe, const Pose& T_camera_reference) {
  reference = keyframe;
  unit = static_cast<float>(map.keyframe(keyframe).unit);
  q_camera_reference = T_camera_reference.quaternion().cast<float>();
  t_camera_reference = T_camera_reference.t.cast<float>();
}

Pose AnchoredPose::T_camera_reference(const Map& map) const {
  return {q_camera_reference.cast<double>().normalized().toRotationMatrix(),
          t_camera_reference.cast<double>() * (map.keyframe(reference).unit / unit)};
}

Pose AnchoredPose::T_camera_world(const Map& map) const {
  return T_camera_reference(map) * map.keyframe(reference).T_camera_world;
}

void rebase(std::span<AnchoredPose> poses, const Map& map, KeyframeId from, KeyframeId to) {
  const Pose T_from_to =
      map.keyframe(from).T_camera_world * map.keyframe(to).T_camera_world.inverse();
  for (AnchoredPose& p : poses)
    if (p.reference == from) p.anchor(map, to, p.T_camera_reference(map) * T_from_to);
}

void drop(std::span<AnchoredPose> poses, KeyframeId reference) {
  for (AnchoredPose& p : poses)
    if (p.reference == reference) p.reference = kNone;
}

}  // namespace depthscope::slam
