#pragma once
#include "overlay/compositor.hpp"
#include "platform/daemon/ar_link.hpp"
#include "platform/daemon/layer_source.hpp"
#include "platform/daemon/video_requests.hpp"

namespace depthscope::platform {

/// Draws overlays from what the AR process sends. All calls from the thread that made it.
class LayerPainter {
 public:
  /// `link` and `requests` outlive it. Throws InputError when graphics cannot be had.
  LayerPainter(const CameraModel& camera, const overlay::OverlaySettings& overlay, ArLink& link,
               VideoRequests& requests);
  /// Allocates when the size differs from what `layer` held before.
  void draw(const LayerRequest& request, OverlayLayer& layer);

 private:
  ArLink& link_;
  VideoRequests& requests_;
  overlay::Compositor compositor_;
};

}  // namespace depthscope::platform
