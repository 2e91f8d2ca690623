#include "platform/label_board.hpp"

namespace depthscope::platform {

bool LabelBoard::anchorWaiting(const SurfaceMesh& mesh, const CameraModel& camera,
                               const PoseEstimate& estimate) {
  if (waiting_.empty() || mesh.empty() || estimate.state != TrackingState::Tracking ||
      estimate.map_id != mesh.map_id)
    return false;
  const std::size_t before = labels_.size();
  std::erase_if(waiting_, [&](const LabelRequest& request) {
    const auto anchor = anchorOnSurface(mesh, camera, estimate.T_camera_world, request.pixel);
    if (anchor) labels_.push_back({next_id_++, mesh.map_id, *anchor, request.text});
    return anchor.has_value();
  });
  return labels_.size() != before;
}

}  // namespace depthscope::platform
