#include "platform/daemon/life_signs.hpp"

#include <systemd/sd-daemon.h>

namespace depthscope::platform {
namespace {

constexpr auto tick = HeartbeatLine::half_period / 2;

std::chrono::microseconds watchdogPeriod() {
  std::uint64_t period_us = 0;
  return std::chrono::microseconds(::sd_watchdog_enabled(0, &period_us) > 0 ? period_us : 0);
}

}  // namespace

WatchdogFeed::Message WatchdogFeed::next(Time now, std::uint64_t presented) {
  if (presented == presented_) return Message::None;
  const bool first = presented_ == 0;
  const bool due = watchdog_.count() > 0 && now - last_ >= watchdog_ / 4;
  if (!first && !due) return Message::None;
  presented_ = presented;
  last_ = now;
  return first ? Message::Ready : Message::Alive;
}

LifeSigns::LifeSigns(const VideoReport& report, const HeartbeatSettings& settings)
    : report_(report),
      gpio_(makeGpioChips()),
      heartbeat_(settings, *gpio_),
      watchdog_(watchdogPeriod()),
      thread_([this] { run(); }) {}

LifeSigns::~LifeSigns() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stopped_.notify_all();
  thread_.join();
}

void LifeSigns::run() {
  std::unique_lock lock(mutex_);
  while (!stopped_.wait_for(lock, tick, [this] { return stopping_; })) {
    const auto now = std::chrono::steady_clock::now();
    feedWatchdog(now);
    heartbeat_.service(now, report_.presented.load(std::memory_order_acquire));
  }
}

/// A display that says what is wrong with it (no monitor, say) is tried again by the video loop
/// itself: a restart would be no faster, so it counts as alive here. For the heartbeat it does not:
/// nothing is to be seen, and a relay that bypasses the box may help.
void LifeSigns::feedWatchdog(std::chrono::steady_clock::time_point now) {
  const std::uint64_t presented = report_.presented.load(std::memory_order_acquire) +
                                  report_.display_faults.load(std::memory_order_acquire);
  switch (watchdog_.next(now, presented)) {
    case WatchdogFeed::Message::None:
      return;
    case WatchdogFeed::Message::Ready:
      ::sd_notify(0, "READY=1\nWATCHDOG=1");
      return;
    case WatchdogFeed::Message::Alive:
      ::sd_notify(0, "WATCHDOG=1");
      return;
  }
}

}  // namespace depthscope::platform
