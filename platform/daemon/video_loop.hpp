#pragma once
#include <memory>
#include <stop_token>
#include <vector>

#include "capture/frame_source.hpp"
#include "overlay/compositor.hpp"
#include "platform/daemon/ar_link.hpp"
#include "platform/daemon/video_report.hpp"
#include "platform/daemon/video_requests.hpp"
#include "platform/display/display.hpp"
#include "platform/histogram.hpp"

namespace depthscope::platform {

/// The picture's way through the box: capture, hand a copy of the luma to the AR process, composite
/// with the newest pose there is, show. All in one thread, which waits for nothing but the next
/// picture.
class VideoLoop {
 public:
  /// All references outlive the loop. The compositor is made by the constructor, so the constructor
  /// runs in the thread that will call run(). Throws InputError when graphics cannot be had.
  VideoLoop(capture::FrameSource& source, const CameraModel& camera,
            const overlay::OverlaySettings& overlay, Display& display, ArLink& ar,
            VideoRequests& requests, VideoReport& report);

  /// Until asked to stop or the clip is over.
  void run(const std::stop_token& stop);

 private:
  void showPicture(const capture::Frame& frame);
  void showFault(capture::SourceStatus status);
  void takeRequests();
  void present(std::span<std::uint8_t> picture, int width, int height);

  capture::FrameSource& source_;
  Display& display_;
  ArLink& ar_;
  VideoRequests& requests_;
  VideoReport& report_;
  overlay::Compositor compositor_;
  std::vector<std::uint8_t> picture_, gray_;
  int width_, height_;       // [px] of the last picture: fault pictures have its size
  std::int64_t shown_ = -1;  // last picture's time in nominal frame times
  Histogram composite_ms_;
};

}  // namespace depthscope::platform
