#include "capture/frame.hpp"

#include <bit>
#include <new>
#include <string>
#include <utility>

#include "types/error.hpp"

namespace depthscope::capture {

namespace {

constexpr std::size_t kAlignment = 64;  // [bytes], a cache line and the widest vector in use

std::size_t roundUp(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

int planeCount(PixelFormat format) {
  switch (format) {
    case PixelFormat::Yuv420p:
    case PixelFormat::Yuv422p:
    case PixelFormat::Yuv444p:
      return 3;
    case PixelFormat::Nv12:
    case PixelFormat::Nv16:
      return 2;
    default:
      return 1;
  }
}

PlaneSize planeSize(const FrameFormat& format, int plane) {
  const int chroma_width = (format.width + 1) / 2;
  const int chroma_height = (format.height + 1) / 2;
  const PlaneSize luma{format.width, format.height};
  switch (format.pixel_format) {
    case PixelFormat::Gray8:
    case PixelFormat::Yuv444p:
      return luma;
    case PixelFormat::Rgb24:
    case PixelFormat::Bgr24:
      return {format.width * 3, format.height};
    case PixelFormat::Rgba32:
    case PixelFormat::Bgrx32:
      return {format.width * 4, format.height};
    case PixelFormat::Yuyv:
    case PixelFormat::Uyvy:
      return {chroma_width * 4, format.height};
    case PixelFormat::Yuv420p:
      return plane == 0 ? luma : PlaneSize{chroma_width, chroma_height};
    case PixelFormat::Yuv422p:
      return plane == 0 ? luma : PlaneSize{chroma_width, format.height};
    case PixelFormat::Nv12:
      return plane == 0 ? luma : PlaneSize{chroma_width * 2, chroma_height};
    case PixelFormat::Nv16:
      return plane == 0 ? luma : PlaneSize{chroma_width * 2, format.height};
  }
  return {};
}

Frame::Frame(Frame&& other) noexcept
    : format(other.format),
      planes(std::exchange(other.planes, {})),
      dma(std::exchange(other.dma, {})),
      sequence(other.sequence),
      capture_time(other.capture_time),
      media_time_s(other.media_time_s),
      damaged(other.damaged),
      lender_(std::exchange(other.lender_, nullptr)),
      slot_(std::exchange(other.slot_, -1)) {}

Frame& Frame::operator=(Frame&& other) noexcept {
  if (this == &other) return *this;
  if (lender_) lender_->takeBack(slot_);
  format = other.format;
  planes = std::exchange(other.planes, {});
  dma = std::exchange(other.dma, {});
  sequence = other.sequence;
  capture_time = other.capture_time;
  media_time_s = other.media_time_s;
  damaged = other.damaged;
  lender_ = std::exchange(other.lender_, nullptr);
  slot_ = std::exchange(other.slot_, -1);
  return *this;
}

Frame::~Frame() {
  if (lender_) lender_->takeBack(slot_);
}

GrayView Frame::luma() const {
  switch (format.pixel_format) {
    case PixelFormat::Gray8:
    case PixelFormat::Yuv420p:
    case PixelFormat::Yuv422p:
    case PixelFormat::Yuv444p:
    case PixelFormat::Nv12:
    case PixelFormat::Nv16:
      return empty() ? GrayView{}
                     : GrayView{planes[0].data, format.width, format.height, planes[0].stride};
    default:
      return {};
  }
}

Frame FrameLender::lend(int slot) {
  Frame frame;
  frame.lender_ = shared_from_this();
  frame.slot_ = slot;
  return frame;
}

void FramePool::AlignedDelete::operator()(std::uint8_t* memory) const {
  ::operator delete[](memory, std::align_val_t{kAlignment});
}

std::shared_ptr<FramePool> FramePool::create(const FrameFormat& format, int buffers) {
  const auto inRange = [](int side) { return side >= 1 && side <= kMaxSide_px; };
  if (!inRange(format.width) || !inRange(format.height))
    throw InputError("picture size " + std::to_string(format.width) + "x" +
                     std::to_string(format.height) + ": expected 1 to " +
                     std::to_string(kMaxSide_px) + " pixels a side");
  if (buffers < 1 || buffers > kMaxBuffers)
    throw InputError("frame buffers " + std::to_string(buffers) + ": expected 1 to " +
                     std::to_string(kMaxBuffers));
  return std::shared_ptr<FramePool>(new FramePool(format, buffers));
}

FramePool::FramePool(const FrameFormat& format, int buffers) : format_(format) {
  for (int plane = 0; plane < planeCount(format.pixel_format); ++plane) {
    const PlaneSize size = planeSize(format, plane);
    const std::size_t stride = roundUp(static_cast<std::size_t>(size.row_bytes));
    offsets_[plane] = static_cast<std::ptrdiff_t>(buffer_bytes_);
    strides_[plane] = static_cast<std::ptrdiff_t>(stride);
    buffer_bytes_ += stride * static_cast<std::size_t>(size.rows);
  }
  // Zeroed, so that the pages are there before a real-time thread first writes to them.
  const std::size_t bytes = buffer_bytes_ * static_cast<std::size_t>(buffers);
  memory_.reset(new (std::align_val_t{kAlignment}) std::uint8_t[bytes]());
  free_slots_ = buffers == kMaxBuffers ? ~std::uint64_t{0} : (std::uint64_t{1} << buffers) - 1;
}

Frame FramePool::acquire() {
  std::uint64_t free = free_slots_.load(std::memory_order_relaxed);
  do {
    if (free == 0) return {};
    // Acquire pairs with the release in release(): the last owner's accesses are over.
  } while (!free_slots_.compare_exchange_weak(free, free & (free - 1), std::memory_order_acquire,
                                              std::memory_order_relaxed));
  const int slot = std::countr_zero(free);
  Frame frame = lend(slot);
  frame.format = format_;
  std::uint8_t* buffer = memory_.get() + buffer_bytes_ * static_cast<std::size_t>(slot);
  for (int plane = 0; plane < planeCount(format_.pixel_format); ++plane)
    frame.planes[plane] = {buffer + offsets_[plane], strides_[plane]};
  return frame;
}

void FramePool::takeBack(int slot) {
  free_slots_.fetch_or(std::uint64_t{1} << slot, std::memory_order_release);
}

}  // namespace depthscope::capture
