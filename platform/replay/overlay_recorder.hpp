#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "capture/frame.hpp"
#include "overlay/compositor.hpp"
#include "platform/histogram.hpp"
#include "platform/video_queue.hpp"
#include "types/tracking.hpp"

namespace depthscope::platform {

/// Composites pictures, records them as a video and keeps the last tracked one.
class OverlayRecorder {
 public:
  /// Pictures are width x height; throws like Compositor and VideoQueue.
  OverlayRecorder(const CameraModel& camera, const overlay::OverlaySettings& settings, double fps,
                  const std::filesystem::path& video);

  overlay::Compositor& compositor() { return compositor_; }
  /// Composites and records one picture, shown at index / fps seconds; false when the encoder was
  /// busy and the picture was given up. Throws std::runtime_error when the video cannot be written.
  bool show(const capture::Frame& frame, overlay::OverlayState state, std::int64_t index,
            VideoQueue::WhenFull when_full, Histogram& composite_ms);
  /// Closes the video and writes the last tracked picture, if there was one. Throws
  /// std::runtime_error.
  void finish(const std::filesystem::path& snapshot);

 private:
  int width_, height_;
  float max_age_ms_;
  overlay::FadeOut fade_out_;
  overlay::Compositor compositor_;
  VideoQueue video_;
  std::vector<std::uint8_t> picture_, snapshot_;
  bool has_snapshot_ = false;
  int failed_composites_ = 0;
};

/// The overlay's state for the picture captured at `time_s`, drawn with this pose.
overlay::OverlayState overlayState(const PoseEstimate& estimate, double time_s);

}  // namespace depthscope::platform
