#pragma once
#include <optional>
#include <stop_token>
#include <vector>

#include "capture/frame_source.hpp"
#include "kernel/system_calls.hpp"
#include "overlay/status_painter.hpp"
#include "platform/daemon/ar_link.hpp"
#include "platform/daemon/frame_ledger.hpp"
#include "platform/daemon/layer_source.hpp"
#include "platform/daemon/overlay_deadline.hpp"
#include "platform/daemon/video_report.hpp"
#include "platform/daemon/video_requests.hpp"
#include "platform/display/display.hpp"

namespace depthscope::platform {

struct VideoLoopSettings {
  float overlay_wait = 0.5f;  // most that a picture waits for its overlay, in frame intervals
  float max_age_ms = 120;     // an overlay by an older pose is not shown
  double stale_s = 1;         // for so long the last picture stays, marked, when no new one comes
};

/// The picture's way through the box: capture, hand a copy of the luma to the AR process, lay over
/// the newest overlay there is, show. All in one thread, which waits for nothing but the next
/// picture and, for a bounded time, the overlay.
class VideoLoop {
 public:
  /// What the loop works with; all of it outlives the loop. `log` may be null.
  struct Parts {
    capture::FrameSource& source;
    Display& display;
    LayerSource& layers;
    ArLink& ar;
    VideoRequests& requests;
    VideoReport& report;
    FrameLog* log;
    kernel::SystemCalls& system;
  };

  /// Pictures have width x height until the source says otherwise. `font_file`: of the status mark.
  /// Throws InputError when the font cannot be had.
  VideoLoop(const Parts& parts, const VideoLoopSettings& settings, const std::string& font_file,
            int width, int height);

  /// Until asked to stop or the clip is over.
  void run(const std::stop_token& stop);
  /// One turn: one picture, or one word on why there is none. False when the clip is over.
  bool turn();

 private:
  using Time = kernel::SystemCalls::Time;

  void showPicture(capture::Frame& frame);
  void giveUp(const capture::Frame& frame, const FrameTimes& times);
  bool presentDirect(capture::Frame& frame, const OverlayLayer* layer, std::span<std::uint8_t> out,
                     FrameTimes& times);
  LayerView markLayer();
  overlay::Mark missingMark() const;
  void showFault(capture::SourceStatus status);
  void resize(int width, int height);
  const OverlayLayer* usableLayer(Time captured) const;
  void compose(const OverlayLayer* layer, std::span<std::uint8_t> out);
  void noteLayer(const OverlayLayer* layer, FrameTimes& times);
  void present(std::span<std::uint8_t> picture, std::int64_t frame);
  void account(const FrameTimes& times);
  void noteSource(const capture::ReadResult& result);

  Parts parts_;
  VideoLoopSettings settings_;
  overlay::StatusPainter painter_;
  std::vector<std::uint8_t> picture_;  // the last one, R G B A, without overlay
  std::vector<std::uint8_t> gray_;
  std::vector<std::uint8_t> mark_layer_;  // for displays that lay overlays over by themselves
  int width_ = 0, height_ = 0;            // [px] of the last picture: fault pictures have its size
  const int camera_width_, camera_height_;  // [px] that the camera file is for
  std::int64_t shown_ = -1;                 // last picture's time in nominal frame times
  std::optional<Time> last_picture_;
  const OverlayLayer* layer_ = nullptr;  // the newest, if any
  std::uint64_t requests_ = 0;
  OverlayDeadline overlay_deadline_;
  FrameLedger ledger_;
  bool noted_ = false;  // the log knows of noted_status_
  capture::SourceStatus noted_status_ = capture::SourceStatus::Ok;
};

}  // namespace depthscope::platform
