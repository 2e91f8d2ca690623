#include "platform/daemon/pose_predictor.hpp"

#include <algorithm>

namespace depthscope::platform {

void PosePredictor::add(const Pose& T_camera_world, std::uint32_t map_id, Time at) {
  if (map_id != map_id_) reset();
  map_id_ = map_id;
  if (last_ && at <= last_->at) {
    // The map may have been corrected meanwhile.
    if (at == last_->at) last_->T_camera_world = T_camera_world;
    return;
  }
  before_ = last_;
  last_ = {T_camera_world, at};
}

Pose PosePredictor::at(Time at) const {
  if (!last_) return {};
  if (!before_ || at <= last_->at) return last_->T_camera_world;
  const std::chrono::duration<double> interval = last_->at - before_->at, ahead = at - last_->at;
  if (interval > longest_interval) return last_->T_camera_world;
  const double steps = std::min(ahead / interval, most_steps);
  // The motion between the two poses, as seen from the camera, scaled: over such short times
  // rotation and translation may be scaled apart.
  const Pose T_last_before = last_->T_camera_world * before_->T_camera_world.inverse();
  return last_->T_camera_world.retract(steps * logSO3(T_last_before.R), steps * T_last_before.t);
}

}  // namespace depthscope::platform
