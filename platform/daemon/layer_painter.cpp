#include "platform/daemon/layer_painter.hpp"

#include <algorithm>

namespace depthscope::platform {

LayerPainter::LayerPainter(const CameraModel& camera, const overlay::OverlaySettings& overlay,
                           ArLink& link, VideoRequests& requests)
    : link_(link), requests_(requests), compositor_(camera, overlay) {}

void LayerPainter::draw(const LayerRequest& request, OverlayLayer& layer) {
  if (const auto settings = requests_.takeOverlay()) compositor_.setSettings(*settings);
  link_.update(compositor_);
  awaitPose(request);
  const auto began = wait_ != nullptr ? wait_->now() : PoseWait::Time();
  const ArLink::View view = link_.view(request.captured, request.width, request.height);
  overlay::OverlayState state = view.state;
  if (request.damaged) state.message = "damaged picture";
  layer.number = request.number;
  layer.width = request.width;
  layer.height = request.height;
  layer.captured = request.captured;
  layer.posed = view.posed;
  layer.pose_captured = view.pose_captured;
  layer.status = state.status;
  layer.pixels.resize(static_cast<std::size_t>(request.width) *
                      static_cast<std::size_t>(request.height) * 4);
  const auto rect = compositor_.drawLayer(request.width, request.height, state, layer.pixels);
  layer.drawn = rect.has_value();
  layer.rect = rect.value_or(overlay::PixelRect{0, 0, request.width, request.height});
  if (wait_ != nullptr)
    drawing_time_ =
        std::max<std::chrono::nanoseconds>(drawing_time_ * 19 / 20, wait_->now() - began);
}

void LayerPainter::awaitPose(const LayerRequest& request) const {
  if (wait_ != nullptr && link_.expectsPose(request.width, request.height))
    wait_->until(request.frame, request.deadline - drawing_time_);
}

}  // namespace depthscope::platform
