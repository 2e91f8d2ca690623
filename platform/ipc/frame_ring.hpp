#pragma once
#include <cstdint>
#include <span>

#include "platform/ipc/shared_memory.hpp"
#include "types/image_view.hpp"

namespace depthscope::platform {

/// Puts pictures into the ring, luma and the small colour picture that goes with it, and rings; the
/// oldest is overwritten. Never waits or
/// allocates.
class FrameRingWriter {
 public:
  explicit FrameRingWriter(const SharedMemory& memory) : memory_(memory) {}
  /// Both have the ring's size; other sizes are left out.
  void publish(const GrayView& luma, const RgbView& color, const WireFrameInfo& info);

 private:
  const SharedMemory& memory_;
  std::uint64_t published_ =
      0;  // the writer's own count: what lies in the memory is never read back
};

/// Takes the newest picture out of the ring.
class FrameRingReader {
 public:
  explicit FrameRingReader(const SharedMemory& memory) : memory_(memory) {}
  /// Copies the newest picture, rows packed, into `pixels` (width * height bytes) and `color` (of
  /// SharedMemory::colorSize()). False when there is none that was not taken before, or it was
  /// overwritten meanwhile.
  bool takeNewest(std::span<std::uint8_t> pixels, std::span<Rgb> color, WireFrameInfo& info);
  /// Pictures that were published but never taken.
  std::uint64_t skipped() const { return skipped_; }

 private:
  const SharedMemory& memory_;
  std::uint64_t seen_ = 0, skipped_ = 0;
};

}  // namespace depthscope::platform
