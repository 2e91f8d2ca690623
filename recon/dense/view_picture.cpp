#include "recon/dense/view_picture.hpp"

#include <algorithm>

namespace depthscope::recon {

int reductionFactor(int width, int wanted) {
  return std::max(1, width / wanted);
}

void copyColor(const RgbView& color, Grid<Rgb>& out) {
  out.width = color.width;
  out.height = color.height;
  out.cells.assign(color.data,
                   color.data + static_cast<std::ptrdiff_t>(color.width) * color.height);
}

void reducePicture(const GrayView& luma, int factor, Grid<std::uint8_t>& out) {
  out.width = luma.width / factor;
  out.height = luma.height / factor;
  out.cells.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
  const int area = factor * factor;
  for (int y = 0; y < out.height; ++y) {
    std::uint8_t* to = out.row(y);
    for (int x = 0; x < out.width; ++x) {
      int sum = area / 2;
      for (int j = 0; j < factor; ++j) {
        const std::uint8_t* from = luma.row(y * factor + j) + x * factor;
        for (int i = 0; i < factor; ++i) sum += from[i];
      }
      to[x] = static_cast<std::uint8_t>(sum / area);
    }
  }
}

}  // namespace depthscope::recon
