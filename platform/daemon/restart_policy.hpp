#pragma once
#include <algorithm>
#include <chrono>

namespace depthscope::platform {

/// When a process that ended is started again: after a wait that doubles with each failure up to a
/// limit, and starts small again once the process ran for longer than the limit. Times are handed
/// in.
class RestartPolicy {
 public:
  using Clock = std::chrono::steady_clock;

  RestartPolicy(std::chrono::nanoseconds min_wait, std::chrono::nanoseconds max_wait)
      : min_wait_(min_wait), max_wait_(std::max(min_wait, max_wait)), wait_(min_wait) {}

  void started(Clock::time_point now) { started_ = now; }
  /// Returns when to start again.
  Clock::time_point ended(Clock::time_point now) {
    if (now - started_ > max_wait_) wait_ = min_wait_;
    const Clock::time_point next = now + wait_;
    wait_ = std::min(max_wait_, 2 * wait_);
    return next;
  }

 private:
  std::chrono::nanoseconds min_wait_, max_wait_, wait_;
  Clock::time_point started_{};
};

}  // namespace depthscope::platform
