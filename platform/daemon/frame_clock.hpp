#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "platform/histogram.hpp"

namespace depthscope::platform {

/// The moments of one picture's way through the box, by the monotonic clock.
struct FrameTimes {
  using Time = std::chrono::steady_clock::time_point;

  std::uint64_t sequence = 0;           // the source's count
  Time captured;                        // by the source
  Time dequeued;                        // the video loop has it
  Time uploaded;                        // converted to the display's colours
  Time overlaid;                        // the overlay is there, or was given up
  Time composited;                      // overlay and picture are one
  Time submitted;                       // given to the display
  std::optional<Time> shown;            // on the glass, where the display tells
  std::optional<float> overlay_age_ms;  // picture's capture time minus that of the pose which the
                                        // overlay hangs on, where it hangs on one
  std::uint8_t overlay_status = 0;      // overlay::Status
  bool damaged = false;                 // the source flagged the picture
};

/// Percentiles of one duration [ms].
struct DurationSummary {
  std::uint64_t count = 0;
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
};
DurationSummary summarize(const Histogram& histogram);

/// Video delay and overlay age apart, and what each stage adds to the delay.
struct FrameClockSummary {
  DurationSummary video_delay;  // captured to submitted
  DurationSummary shown_delay;  // captured to on the glass, where the display tells
  DurationSummary overlay_age;
  DurationSummary dequeue, upload, overlay_wait, blend, submit;
};

/// Durations of all pictures so far, in fixed memory. From one thread.
class FrameClock {
 public:
  void add(const FrameTimes& times);
  /// The display says when a picture captured at `captured` was on the glass.
  void addShown(FrameTimes::Time captured, FrameTimes::Time shown);
  FrameClockSummary summary() const;

 private:
  Histogram video_delay_, shown_delay_, overlay_age_;
  Histogram dequeue_, upload_, overlay_wait_, blend_, submit_;
};

}  // namespace depthscope::platform
