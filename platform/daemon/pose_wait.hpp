#pragma once
#include <cstdint>

#include "kernel/system_calls.hpp"
#include "platform/ipc/shared_memory.hpp"

namespace depthscope::platform {

/// Waits, for a bounded time, until the AR process has looked at a picture, so that an overlay can
/// be drawn by the picture's own pose. From the thread that draws.
class PoseWait {
 public:
  using Time = kernel::SystemCalls::Time;

  /// Both outlive it.
  PoseWait(const SharedMemory& memory, kernel::SystemCalls& system)
      : memory_(memory), system_(system) {}

  /// Until the newest pose is of `frame` or of a later picture, but not beyond `deadline`. An AR
  /// process that is more than `most_behind` pictures behind would only hold the picture up for
  /// nothing: it is not waited for. True when the pose is there.
  bool until(std::int64_t frame, Time deadline) const;
  Time now() const { return system_.now(); }

 private:
  static constexpr std::int64_t most_behind = 2;

  const SharedMemory& memory_;
  kernel::SystemCalls& system_;
};

}  // namespace depthscope::platform
