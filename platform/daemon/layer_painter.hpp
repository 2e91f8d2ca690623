#pragma once
#include "overlay/compositor.hpp"
#include "platform/daemon/ar_link.hpp"
#include "platform/daemon/layer_source.hpp"
#include "platform/daemon/pose_wait.hpp"
#include "platform/daemon/video_requests.hpp"

namespace depthscope::platform {

/// Draws overlays from what the AR process sends. All calls from the thread that made it.
class LayerPainter {
 public:
  /// `link` and `requests` outlive it. Throws InputError when graphics cannot be had.
  LayerPainter(const CameraModel& camera, const overlay::OverlaySettings& overlay, ArLink& link,
               VideoRequests& requests);
  /// Draws each overlay by the pose of the very picture it is for, where that comes in time. `wait`
  /// outlives the painter; null: by the newest pose there is.
  void waitForPoses(const PoseWait* wait) { wait_ = wait; }
  /// Allocates when the size differs from what `layer` held before.
  void draw(const LayerRequest& request, OverlayLayer& layer);

 private:
  void awaitPose(const LayerRequest& request) const;

  ArLink& link_;
  VideoRequests& requests_;
  overlay::Compositor compositor_;
  const PoseWait* wait_ = nullptr;
  std::chrono::nanoseconds drawing_time_{0};  // to be left of the time that there is
};

}  // namespace depthscope::platform
