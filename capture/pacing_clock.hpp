#pragma once
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace depthscope::capture {

/// The time by which a clip is played, so that tests can play it by a simulated one. Used from the
/// reading and the decoding thread at once.
class PacingClock {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  virtual ~PacingClock() = default;
  virtual TimePoint now() const = 0;
  /// Lets time go by until `time`; returns at once when it is over.
  virtual void sleepUntil(TimePoint time) = 0;
  /// Waits for another thread's work: until `changed` is notified (true) or `until` has come
  /// (false). A simulated clock, by which work takes no time, always waits for the notification.
  virtual bool waitForWork(std::condition_variable& changed, std::unique_lock<std::mutex>& lock,
                           TimePoint until) = 0;

  /// The machine's monotonic clock.
  static PacingClock& steady();
};

}  // namespace depthscope::capture
