#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "types/image_view.hpp"

namespace depthscope::capture {

enum class PixelFormat : std::uint8_t {
  Gray8,    // 1 plane, 8-bit luma
  Rgb24,    // 1 plane, R G B
  Bgr24,    // 1 plane, B G R
  Rgba32,   // 1 plane, R G B A
  Yuv420p,  // 3 planes Y, U, V; chroma halved both ways (V4L2 YU12)
  Nv12,     // 2 planes Y, UV interleaved; chroma halved both ways
};

/// How YUV maps to RGB. For RGB formats both are ignored; Gray8 is luma, so its range counts.
enum class YuvMatrix : std::uint8_t { Bt601, Bt709 };
enum class YuvRange : std::uint8_t { Limited, Full };

struct Plane {
  std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;  // [bytes]
};

/// What a buffer holds: everything needed to allocate it and to read it.
struct FrameFormat {
  PixelFormat pixel_format = PixelFormat::Yuv420p;
  int width = 0, height = 0;  // [px]
  YuvMatrix matrix = YuvMatrix::Bt601;
  YuvRange range = YuvRange::Limited;
  bool operator==(const FrameFormat&) const = default;
};

/// Number of planes of a pixel format, 1 to 3.
int planeCount(PixelFormat format);

/// What plane `plane` of a picture occupies: rows of `row_bytes` bytes that carry pixels. Chroma of
/// a picture of odd size is rounded up.
struct PlaneSize {
  int row_bytes = 0;
  int rows = 0;
};
PlaneSize planeSize(const FrameFormat& format, int plane);

class FramePool;

/// One picture in a buffer borrowed from a FramePool; the buffer goes back when the Frame is
/// destroyed. Move-only: exactly one owner at a time.
class Frame {
 public:
  Frame() = default;
  Frame(Frame&&) noexcept;
  Frame& operator=(Frame&&) noexcept;
  ~Frame();

  bool empty() const { return pool_ == nullptr; }
  /// The luma plane, without a copy, where the format has one (Gray8, Yuv420p, Nv12); else empty.
  GrayView luma() const;

  FrameFormat format;
  std::array<Plane, 3> planes{};
  std::uint64_t sequence = 0;  // the source's own count; a gap means frames were skipped
  std::chrono::steady_clock::time_point capture_time;  // monotonic, when the picture was captured
  double media_time_s = 0;  // position in the clip: sequence / fps; live sources: capture time
  bool damaged = false;     // the source flagged the picture as damaged

 private:
  friend class FramePool;
  std::shared_ptr<FramePool> pool_;
  int slot_ = -1;
};

/// A fixed number of equal buffers, all allocated at construction (64-byte aligned rows).
/// Thread-safe and lock-free, so that a real-time thread never waits for another one to give a
/// buffer back. Held by shared_ptr because a Frame may outlive the source that filled it.
class FramePool : public std::enable_shared_from_this<FramePool> {
 public:
  static constexpr int kMaxBuffers = 64;
  static constexpr int kMaxSide_px = 16384;

  /// Throws InputError when `buffers` or the size are out of range
  /// (1..kMaxBuffers, 1..kMaxSide_px).
  static std::shared_ptr<FramePool> create(const FrameFormat& format, int buffers);
  /// A free buffer wrapped as a Frame, or an empty Frame when all are in use; its pixels are
  /// whatever was in it before. Never allocates or waits.
  Frame acquire();
  const FrameFormat& format() const { return format_; }

 private:
  friend class Frame;
  struct AlignedDelete {
    void operator()(std::uint8_t* memory) const;
  };

  FramePool(const FrameFormat& format, int buffers);
  void release(int slot);

  FrameFormat format_;
  std::array<std::ptrdiff_t, 3> offsets_{};  // [bytes] of each plane within a buffer
  std::array<std::ptrdiff_t, 3> strides_{};  // [bytes]
  std::size_t buffer_bytes_ = 0;
  std::unique_ptr<std::uint8_t[], AlignedDelete> memory_;
  std::atomic<std::uint64_t> free_slots_{0};  // bit i: buffer i is free
};

}  // namespace depthscope::capture
