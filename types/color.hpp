#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace depthscope {

using Rgb = std::array<std::uint8_t, 3>;  // R G B, 0..255

/// Borrowed R G B picture, rows packed. The owner of the pixels must outlive the view.
struct RgbView {
  const Rgb* data = nullptr;
  int width = 0, height = 0;  // [px]

  const Rgb* row(int y) const { return data + static_cast<std::ptrdiff_t>(y) * width; }
  bool empty() const { return data == nullptr; }
};

/// The small colour picture that goes with each luma picture, for the colour of surfaces: a pixel
/// stands for factor x factor of the captured picture; what is left over at the right and bottom is
/// cut off. Its pixels are as fine as the vertices of a surface; at 1920x1080 it takes a fortieth
/// of the memory of the luma.
struct ColorReduction {
  static constexpr int wanted_width = 160;  // [px]

  int factor = 1, width = 0, height = 0;  // [px]

  ColorReduction() = default;
  /// For captured pictures of this size.
  ColorReduction(int captured_width, int captured_height)
      : factor(std::max(1, (captured_width + wanted_width / 2) / wanted_width)),
        width(captured_width / factor),
        height(captured_height / factor) {}
  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

}  // namespace depthscope
