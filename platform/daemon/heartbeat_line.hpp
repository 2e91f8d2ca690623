#pragma once
#include <chrono>
#include <cstdint>
#include <memory>

#include "platform/config/settings.hpp"
#include "platform/footswitch/gpio.hpp"

namespace depthscope::platform {

/// A GPIO line that changes its level as long as pictures go out, so that a relay with a
/// retriggerable timer behind it can switch tower and monitor together, past the box, when none do:
/// whether the box has crashed, hangs, lost its monitor or has no power. A line that is missing or
/// fails is looked for again and again.
class HeartbeatLine {
 public:
  using Time = std::chrono::steady_clock::time_point;
  /// The least time between two changes: a relay sees 10 Hz at most.
  static constexpr std::chrono::milliseconds half_period{50};

  /// `chips` outlives it. Without a line in the settings it does nothing.
  HeartbeatLine(const HeartbeatSettings& settings, GpioChips& chips);

  /// To be called often. `presented`: pictures and fault pictures given to the display so far.
  void service(Time now, std::uint64_t presented);

 private:
  void open(Time now);
  void note(int error);

  GpioLineConfig config_;
  GpioChips& chips_;
  std::unique_ptr<GpioOutput> output_;
  bool active_ = false;
  int error_ = 0;
  bool noted_ = false;  // the log knows of error_
  std::uint64_t presented_ = 0;
  Time next_try_{}, last_change_{};
};

}  // namespace depthscope::platform
