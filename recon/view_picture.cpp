#include "recon/view_picture.hpp"

#include <algorithm>

#include "types/vector_clones.hpp"

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

namespace {

DEPTHSCOPE_CLONES
void halveRow(int width, const std::uint8_t* __restrict upper, const std::uint8_t* __restrict lower,
              std::uint8_t* __restrict to) {
  for (int x = 0; x < width; ++x)
    to[x] = static_cast<std::uint8_t>(
        (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 2) / 4);
}

void reduceRow(const GrayView& luma, int factor, int y, int width, std::uint8_t* to) {
  const int area = factor * factor;
  for (int x = 0; x < width; ++x) {
    int sum = area / 2;
    for (int j = 0; j < factor; ++j) {
      const std::uint8_t* from = luma.row(y * factor + j) + x * factor;
      for (int i = 0; i < factor; ++i) sum += from[i];
    }
    to[x] = static_cast<std::uint8_t>(sum / area);
  }
}

}  // namespace

void reducePicture(const GrayView& luma, int factor, Grid<std::uint8_t>& out) {
  out.resize(luma.width / factor, luma.height / factor);
  for (int y = 0; y < out.height; ++y) {
    if (factor == 2)
      halveRow(out.width, luma.row(2 * y), luma.row(2 * y + 1), out.row(y));
    else
      reduceRow(luma, factor, y, out.width, out.row(y));
  }
}

}  // namespace depthscope::recon
