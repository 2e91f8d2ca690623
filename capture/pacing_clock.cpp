#include "capture/pacing_clock.hpp"

#include <thread>

namespace depthscope::capture {

namespace {

class SteadyClock final : public PacingClock {
 public:
  TimePoint now() const override { return std::chrono::steady_clock::now(); }
  void sleepUntil(TimePoint time) override { std::this_thread::sleep_until(time); }
  bool waitForWork(std::condition_variable& changed, std::unique_lock<std::mutex>& lock,
                   TimePoint until) override {
    return changed.wait_until(lock, until) == std::cv_status::no_timeout;
  }
};

}  // namespace

PacingClock& PacingClock::steady() {
  static SteadyClock clock;
  return clock;
}

}  // namespace depthscope::capture
