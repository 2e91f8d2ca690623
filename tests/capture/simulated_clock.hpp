#pragma once
#include <algorithm>
#include <atomic>

#include "capture/pacing_clock.hpp"

namespace depthscope::capture {

/// Time that passes only when someone sleeps or a test says so; decoding takes none of it.
class SimulatedClock final : public PacingClock {
 public:
  TimePoint now() const override { return TimePoint(std::chrono::nanoseconds(now_.load())); }
  void sleepUntil(TimePoint time) override {
    now_ = std::max(now_.load(),
                    std::int64_t{std::chrono::nanoseconds(time.time_since_epoch()).count()});
  }
  bool waitForWork(std::condition_variable& changed, std::unique_lock<std::mutex>& lock,
                   TimePoint) override {
    changed.wait(lock);
    return true;
  }
  void advance(std::chrono::nanoseconds time) { now_ += time.count(); }

 private:
  std::atomic<std::int64_t> now_{1'000'000'000};
};

}  // namespace depthscope::capture
