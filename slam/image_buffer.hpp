#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "types/image_view.hpp"

namespace depthscope::slam {

/// An owned 8-bit picture of fixed size. Rows may be read and written up to `stride`, which leaves
/// at least 64 bytes behind the last pixel, so that kernels need not treat the end of a row apart.
class ImageBuffer {
 public:
  ImageBuffer() = default;
  ImageBuffer(int width, int height)
      : width_(width),
        height_(height),
        stride_((width + 127) / 64 * 64),
        pixels_(static_cast<std::size_t>(stride_) * height) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }
  std::uint8_t* row(int y) { return pixels_.data() + y * stride_; }
  const std::uint8_t* row(int y) const { return pixels_.data() + y * stride_; }
  GrayView view() const { return {pixels_.data(), width_, height_, stride_}; }

  /// Copies a picture of the same size.
  void assign(const GrayView& image) {
    for (int y = 0; y < height_; ++y) std::memcpy(row(y), image.row(y), width_);
  }

 private:
  int width_ = 0, height_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace depthscope::slam
