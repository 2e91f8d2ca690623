#pragma once
#include <poll.h>

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "kernel/system_calls.hpp"
#include "platform/footswitch/footswitch_settings.hpp"
#include "platform/footswitch/pedal.hpp"

namespace depthscope::platform {

/// The surgeon's foot: all pedals of the settings together. Served from one thread's poll loop.
class Footswitch {
 public:
  static constexpr std::size_t max_pedals = 2;
  using Time = Pedal::Time;

  /// The pedals that the settings name; none is an error. `chips` and `calls` outlive it.
  Footswitch(const FootswitchSettings& settings, GpioChips& chips, kernel::SystemCalls& calls);

  std::size_t pedals() const { return pedals_.size(); }
  /// What to wait for: one entry a pedal, in order; fd -1 (to be ignored) while one is missing.
  void addTo(std::span<pollfd> descriptors) const;
  /// How long a wait may last at most, in milliseconds.
  int waitAtMost(Time now, int ms) const;
  /// After the wait: how often a pedal was pressed.
  int service(Time now, std::span<const pollfd> descriptors);

  /// "off" (none configured), "ready", or why a pedal is not there.
  std::string state() const;
  std::uint64_t presses() const { return presses_; }
  std::uint64_t lost() const;

 private:
  void logChange(std::size_t pedal);

  std::vector<std::unique_ptr<Pedal>> pedals_;
  std::array<int, max_pedals> logged_error_{};  // 1: nothing logged yet
  std::uint64_t presses_ = 0;
};

}  // namespace depthscope::platform
