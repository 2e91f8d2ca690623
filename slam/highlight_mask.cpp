#include "slam/highlight_mask.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

/// The brightest of each column of rows y..y+cell-1 (cell: a multiple of 4). Behind the last column
/// `highest` stays zero.
void highestOfRows(const ImageBuffer& image, int y, int cell, std::uint8_t* __restrict highest) {
  const int width = image.width();
  std::fill_n(highest, width, std::uint8_t{0});
  for (int i = 0; i < cell; i += 4) {
    const auto row = [&](int k) { return image.row(std::min(y + i + k, image.height() - 1)); };
    const std::uint8_t *a = row(0), *b = row(1), *c = row(2), *d = row(3);
    for (int x = 0; x < width; ++x)
      highest[x] = std::max(highest[x], std::max(std::max(a[x], b[x]), std::max(c[x], d[x])));
  }
}

}  // namespace

HighlightMask::HighlightMask(const ImagePyramid& pyramid, const ExtractorSettings& settings)
    : cell_(pyramid.level(0).width() < 800 ? 4 : 8),
      specular_threshold_(settings.specular_threshold),
      dark_threshold_(settings.dark_threshold),
      contrast_(static_cast<std::uint32_t>(std::lround(settings.specular_contrast * 256))),
      highlights_(pyramid.level(0).width(), pyramid.level(0).height(), cell_),
      brightness_(pyramid.level(pyramid.levels() - 1)),
      highest_(pyramid.level(0).stride()),
      tissue_(highlights_.columns()) {}

void HighlightMask::update(const ImagePyramid& pyramid) {
  brightness_.update(pyramid.level(pyramid.levels() - 1), dark_threshold_);
  highlights_.clear();
  bool any = false;
  for (int r = 0; r < highlights_.rows(); ++r) {
    highestOfRows(pyramid.level(0), r * cell_, cell_, highest_.data());
    brightness_.sampleRow((r + 0.5) / highlights_.rows(), tissue_);
    for (int c = 0; c < highlights_.columns(); ++c) {
      const std::uint8_t* cell = highest_.data() + c * cell_;
      std::uint8_t high = 0;
      for (int i = 0; i < cell_; ++i) high = std::max(high, cell[i]);
      const auto limit = static_cast<int>((tissue_[c] * contrast_) >> 16);
      if (high < std::min(limit, specular_threshold_)) continue;
      highlights_.mark(c, r);
      any = true;
    }
  }
  if (any) highlights_.propagate();
}

}  // namespace depthscope::slam
