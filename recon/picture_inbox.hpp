#pragma once
#include <array>
#include <atomic>
#include <cstdint>

#include "recon/view_picture.hpp"

namespace depthscope::recon {

/// Views on their way from tracking to reconstruction: a ring of fixed capacity with one writer
/// and one reader, neither of which waits. When it is full the new picture is left out.
class PictureInbox {
 public:
  /// Room is made for pictures of width x height and their colour, luma reduced by `factor`; 0: no
  /// luma is kept.
  PictureInbox(int width, int height, int factor) : factor_(factor) {
    const ColorReduction color(width, height);
    for (ViewPicture& slot : slots_) {
      if (factor > 0) slot.luma.reset(width / factor, height / factor);
      slot.color.reset(color.width, color.height);
    }
  }

  /// Reduces the picture into the ring; false when that is full. From the writer's thread.
  bool put(const GrayView& luma, const RgbView& color, std::int64_t frame) {
    const std::uint64_t next = put_.load(std::memory_order_relaxed);
    if (next - taken_.load(std::memory_order_acquire) == kSlots) return false;
    ViewPicture& slot = slots_[next % kSlots];
    slot.frame = frame;
    if (factor_ > 0) reducePicture(luma, factor_, slot.luma);
    copyColor(color, slot.color);
    put_.store(next + 1, std::memory_order_release);
    return true;
  }
  /// Whether there is a picture. From the reader's thread.
  bool waiting() const {
    return put_.load(std::memory_order_acquire) != taken_.load(std::memory_order_relaxed);
  }
  /// The oldest picture, where waiting(): good until pop().
  const ViewPicture& front() const {
    return slots_[taken_.load(std::memory_order_relaxed) % kSlots];
  }
  void pop() {
    taken_.store(taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

 private:
  static constexpr std::uint64_t kSlots = 32;  // views kept while one surface is worked out

  int factor_;
  std::array<ViewPicture, kSlots> slots_;
  std::atomic<std::uint64_t> put_ = 0, taken_ = 0;
};

}  // namespace depthscope::recon
