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
  Bgrx32,   // 1 plane, B G R and a byte without meaning (V4L2 XR24)
  Yuv420p,  // 3 planes Y, U, V; chroma halved both ways (V4L2 YU12)
  Yuv422p,  // 3 planes; chroma halved across
  Yuv444p,  // 3 planes of one size
  Nv12,     // 2 planes Y, UV interleaved; chroma halved both ways
  Nv16,     // 2 planes Y, UV interleaved; chroma halved across
  Yuyv,     // 1 plane, Y U Y V for two pixels
  Uyvy,     // 1 plane, U Y V Y for two pixels
};
inline constexpr int kPixelFormats = 13;

/// How YUV maps to RGB; no matter for RGB formats.
enum class YuvMatrix : std::uint8_t { Bt601, Bt709, Bt2020 };
/// Limited: black is 16 and white 235, in RGB too, as HDMI carries television modes.
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

/// The same pixels as a DMABUF, for hardware that reads them by itself. Borrowed: good for as long
/// as the Frame lives.
struct DmaPlane {
  int fd = -1;               // none: -1
  std::uint32_t offset = 0;  // [bytes] of the plane within the DMABUF; its stride is the Plane's
};

class FrameLender;

/// One picture in a buffer borrowed from a FrameLender; the buffer goes back when the Frame is
/// destroyed. Move-only: exactly one owner at a time.
class Frame {
 public:
  Frame() = default;
  Frame(Frame&&) noexcept;
  Frame& operator=(Frame&&) noexcept;
  ~Frame();

  bool empty() const { return lender_ == nullptr; }
  /// The luma plane, without a copy, where the format has one (Gray8, planar and
  /// semi-planar YUV); else empty.
  GrayView luma() const;

  FrameFormat format;
  std::array<Plane, 3> planes{};
  std::array<DmaPlane, 3> dma{};
  std::uint64_t sequence = 0;  // the source's own count; a gap means frames were skipped
  std::chrono::steady_clock::time_point capture_time;  // monotonic, when the picture was captured
  double media_time_s = 0;  // position in the clip: sequence / fps; live sources: capture time
  bool damaged = false;     // the source flagged the picture as damaged

 private:
  friend class FrameLender;
  std::shared_ptr<FrameLender> lender_;
  int slot_ = -1;
};

/// Owns buffers and lends them out as Frames. Held by shared_ptr because a Frame may outlive the
/// source that filled it.
class FrameLender : public std::enable_shared_from_this<FrameLender> {
 public:
  virtual ~FrameLender() = default;

 protected:
  /// A Frame without content that brings `slot` back when it is destroyed.
  Frame lend(int slot);

 private:
  friend class Frame;
  /// From any thread; neither waits nor allocates nor throws.
  virtual void takeBack(int slot) = 0;
};

/// A fixed number of equal buffers, all allocated at construction (64-byte aligned rows).
/// Thread-safe and lock-free, so that a real-time thread never waits for another one to give a
/// buffer back.
class FramePool final : public FrameLender {
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
  struct AlignedDelete {
    void operator()(std::uint8_t* memory) const;
  };

  FramePool(const FrameFormat& format, int buffers);
  void takeBack(int slot) override;

  FrameFormat format_;
  std::array<std::ptrdiff_t, 3> offsets_{};  // [bytes] of each plane within a buffer
  std::array<std::ptrdiff_t, 3> strides_{};  // [bytes]
  std::size_t buffer_bytes_ = 0;
  std::unique_ptr<std::uint8_t[], AlignedDelete> memory_;
  std::atomic<std::uint64_t> free_slots_{0};  // bit i: buffer i is free
};

}  // namespace depthscope::capture
