#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>

namespace depthscope::platform {

/// Remembers when the last pictures given to the AR process were captured, so that a pose's age is
/// worked out from what the video process itself knows, not from a time that the AR process tells.
/// One thread adds, another asks.
class PublishedFrames {
 public:
  using Time = std::chrono::steady_clock::time_point;

  void add(std::int64_t frame, Time captured) {
    Entry& entry = entries_[slot(frame)];
    entry.frame.store(-1, std::memory_order_relaxed);
    entry.captured.store(captured.time_since_epoch().count(), std::memory_order_release);
    entry.frame.store(frame, std::memory_order_release);
  }
  /// Capture time of a frame, or nothing when it was never published or is long past.
  std::optional<Time> captured(std::int64_t frame) const {
    if (frame < 0) return std::nullopt;
    const Entry& entry = entries_[slot(frame)];
    if (entry.frame.load(std::memory_order_acquire) != frame) return std::nullopt;
    const Time::rep at = entry.captured.load(std::memory_order_acquire);
    if (entry.frame.load(std::memory_order_relaxed) != frame) return std::nullopt;
    return Time(Time::duration(at));
  }

 private:
  static constexpr std::size_t kept = 256;  // 4 s at 60 pictures a second
  struct Entry {
    std::atomic<std::int64_t> frame{-1};
    std::atomic<Time::rep> captured{0};
  };
  static std::size_t slot(std::int64_t frame) { return static_cast<std::size_t>(frame) % kept; }
  std::array<Entry, kept> entries_{};
};

}  // namespace depthscope::platform
