#pragma once
#include <array>
#include <chrono>
#include <cstdint>

#include "platform/daemon/frame_clock.hpp"
#include "platform/daemon/frame_log.hpp"

namespace depthscope::platform {

/// Keeps account of the pictures that went out: their durations, and a line for each in the frame
/// log. When a picture was on the glass is known some pictures later only: until then its line
/// waits, in fixed memory. From one thread.
class FrameLedger {
 public:
  using Time = FrameTimes::Time;

  /// `log` may be null, else it outlives the ledger.
  explicit FrameLedger(FrameLog* log) : log_(log) {}
  /// Writes the lines that still wait.
  ~FrameLedger();
  FrameLedger(const FrameLedger&) = delete;
  FrameLedger& operator=(const FrameLedger&) = delete;

  /// Picture `index` was given to the display; indices grow.
  void submitted(std::int64_t index, const FrameTimes& times);
  /// The display says when picture `index` was on the glass; in the order in which they were. Those
  /// given to it before and not told of never were.
  void shown(std::int64_t index, Time at);

  FrameClockSummary summary() const { return clock_.summary(); }

 private:
  struct Line {
    std::int64_t index = -1;
    FrameTimes times;
  };
  Line& oldest() { return waiting_[written_ % waiting_.size()]; }
  void writeOldest();

  FrameLog* log_;
  FrameClock clock_;
  std::array<Line, 16> waiting_;  // displays tell of a picture with the next one or the one after
  std::uint64_t added_ = 0, written_ = 0;
};

}  // namespace depthscope::platform
