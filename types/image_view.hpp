#pragma once
#include <cstddef>
#include <cstdint>

namespace depthscope {

/// Borrowed 8-bit single-channel picture, row-major, `stride` bytes from a row to the next. The
/// owner of the pixels must outlive the view.
struct GrayView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;  // [px]
  std::ptrdiff_t stride = 0;  // [bytes]

  const std::uint8_t* row(int y) const { return data + y * stride; }
  bool empty() const { return data == nullptr; }
};

/// Borrowed 8-bit RGBA picture (byte order R, G, B, A), row-major.
struct RgbaView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;  // [px]
  std::ptrdiff_t stride = 0;  // [bytes]

  const std::uint8_t* row(int y) const { return data + y * stride; }
  bool empty() const { return data == nullptr; }
};

}  // namespace depthscope
