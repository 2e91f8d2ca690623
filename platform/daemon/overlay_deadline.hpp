#pragma once
#include <algorithm>
#include <chrono>
#include <optional>

namespace depthscope::platform {

/// Until when a picture may wait for its overlay: a share of the frame interval, counted from when
/// a picture of its capture time usually reaches the loop. So a picture that was held up does not
/// hold up the next, and waits never add up to a picture that is passed over. Times are handed in.
class OverlayDeadline {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Time next(Time captured, Time dequeued, std::chrono::nanoseconds wait) {
    const std::chrono::nanoseconds delay = dequeued - captured;
    usual_delay_ = usual_delay_ ? std::min(*usual_delay_ + drift, delay) : delay;
    return captured + *usual_delay_ + wait;
  }
  /// Pictures come from elsewhere now.
  void reset() { usual_delay_.reset(); }

 private:
  // How fast the usual delay may grow again, a picture: a card whose clock runs off by 1 % is
  // followed, a loop that is late is not.
  static constexpr std::chrono::microseconds drift{300};
  std::optional<std::chrono::nanoseconds> usual_delay_;
};

}  // namespace depthscope::platform
