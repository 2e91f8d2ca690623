#pragma once
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>

#include "platform/daemon/heartbeat_line.hpp"
#include "platform/daemon/video_report.hpp"

namespace depthscope::platform {

/// When systemd is told that the service is up and well. Times are handed in.
class WatchdogFeed {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class Message { None, Ready, Alive };

  /// `watchdog`: how long systemd waits for a sign; zero: it does not.
  explicit WatchdogFeed(std::chrono::microseconds watchdog) : watchdog_(watchdog) {}

  /// What to say, given how many pictures went out so far: Ready with the first, then Alive, four
  /// times as often as needed, only when there was one since.
  Message next(Time now, std::uint64_t presented);

 private:
  std::chrono::microseconds watchdog_;
  std::uint64_t presented_ = 0;
  Time last_{};
};

/// Tells the outside that pictures go out: systemd's watchdog, and the heartbeat line. In a thread
/// that does nothing else, so that whatever holds the service up (a disk that is slow to take a
/// snapshot, an AR program that is slow to start) is not taken for a picture that stands still.
class LifeSigns {
 public:
  /// `report` outlives it.
  LifeSigns(const VideoReport& report, const HeartbeatSettings& settings);
  ~LifeSigns();
  LifeSigns(const LifeSigns&) = delete;
  LifeSigns& operator=(const LifeSigns&) = delete;

 private:
  void run();
  void feedWatchdog(std::chrono::steady_clock::time_point now);

  const VideoReport& report_;
  std::unique_ptr<GpioChips> gpio_;
  HeartbeatLine heartbeat_;
  WatchdogFeed watchdog_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;
  std::thread thread_;  // last: it uses what stands above
};

}  // namespace depthscope::platform
