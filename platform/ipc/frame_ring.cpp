#include "platform/ipc/frame_ring.hpp"

#include <cmath>

namespace depthscope::platform {

void FrameRingWriter::publish(const GrayView& luma, const RgbView& color,
                              const WireFrameInfo& info) {
  const SharedCapacity& c = memory_.capacity();
  const ColorReduction reduced = memory_.colorSize();
  if (luma.empty() || luma.width != static_cast<int>(c.width) ||
      luma.height != static_cast<int>(c.height) || color.empty() || color.width != reduced.width ||
      color.height != reduced.height)
    return;
  const auto slot = static_cast<std::uint32_t>(published_ % ring_slots);
  SharedBlock::FrameSlot& head = memory_.block().frames[slot];
  seqlock::Word* to = memory_.pixels(slot);
  seqlock::beginWrite(head.count);
  seqlock::store(head.info, &info, sizeof info);
  if (luma.stride == luma.width || c.width % 8 == 0) {
    // Rows of whole words go one by one; packed pictures of any width in one go.
    const bool packed = luma.stride == luma.width;
    const std::size_t row_bytes = packed ? static_cast<std::size_t>(c.width) * c.height : c.width;
    for (std::uint32_t y = 0; y < (packed ? 1 : c.height); ++y)
      seqlock::store(to + y * (c.width / 8), luma.row(static_cast<int>(y)), row_bytes);
  } else {
    // Words that hold the end of one row and the start of the next are put together byte by byte.
    std::uint8_t word[8];
    const std::size_t total = static_cast<std::size_t>(c.width) * c.height;
    for (std::size_t i = 0; i < total; ++i) {
      word[i % 8] = luma.row(static_cast<int>(i / c.width))[i % c.width];
      if (i % 8 == 7 || i + 1 == total) seqlock::store(to + i / 8, word, i % 8 + 1);
    }
  }
  seqlock::store(memory_.color(slot), color.data, reduced.pixels() * sizeof(Rgb));
  seqlock::endWrite(head.count);
  memory_.block().frames_published.store(++published_, std::memory_order_release);
  memory_.block().new_frame.ring();
}

bool FrameRingReader::takeNewest(std::span<std::uint8_t> pixels, std::span<Rgb> color,
                                 WireFrameInfo& info) {
  const SharedCapacity& c = memory_.capacity();
  const std::size_t bytes = static_cast<std::size_t>(c.width) * c.height;
  const std::uint64_t published = memory_.block().frames_published.load(std::memory_order_acquire);
  const std::size_t color_pixels = memory_.colorSize().pixels();
  if (published == 0 || published == seen_ || pixels.size() < bytes || color.size() < color_pixels)
    return false;
  const auto slot = static_cast<std::uint32_t>((published - 1) % ring_slots);
  const SharedBlock::FrameSlot& head = memory_.block().frames[slot];
  const std::uint64_t before = seqlock::beginRead(head.count);
  WireFrameInfo read;
  seqlock::load(&read, head.info, sizeof read);
  seqlock::load(pixels.data(), memory_.pixels(slot), bytes);
  seqlock::load(color.data(), memory_.color(slot), color_pixels * sizeof(Rgb));
  if (before == 0 || !seqlock::endRead(head.count, before))
    return false;  // a newer one is there or on its way
  if (published > seen_ + 1) skipped_ += published - seen_ - 1;
  seen_ = published;
  if (read.frame < 0 || !std::isfinite(read.timestamp_s)) return false;
  info = read;
  return true;
}

}  // namespace depthscope::platform
