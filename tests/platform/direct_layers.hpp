#pragma once
#include "platform/daemon/layer_painter.hpp"

namespace depthscope::platform {

/// Draws overlays in the loop's own thread, for they are then there at once and always the same.
/// Can act a driver that hangs.
class DirectLayers final : public LayerSource {
 public:
  explicit DirectLayers(LayerPainter& painter) : painter_(painter) {}
  void request(const LayerRequest& request) override { request_ = request; }
  const OverlayLayer* newest(std::chrono::steady_clock::time_point) override {
    if (!hung && layer_.number != request_.number) painter_.draw(request_, layer_);
    return layer_.number > 0 ? &layer_ : nullptr;
  }
  bool hung = false;

 private:
  LayerPainter& painter_;
  LayerRequest request_;
  OverlayLayer layer_;
};

}  // namespace depthscope::platform
