#include "slam/highlight_mask.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

void raise(std::uint8_t* __restrict to, const std::uint8_t* __restrict from, int width) {
  for (int x = 0; x < width; ++x) to[x] = std::max(to[x], from[x]);
}

/// highest[x]: the brightest of the cell x cell pixels right of and below (x, y). `workspace` has 8
/// bytes more than `highest`, and both hold whole cells.
void highestOfCells(const ImageBuffer& image, int y, int cell, std::vector<std::uint8_t>& workspace,
                    std::vector<std::uint8_t>& highest) {
  const int width = image.width();
  std::fill(highest.begin(), highest.end(), std::uint8_t{0});
  for (int i = 0; i < cell; ++i)
    raise(highest.data(), image.row(std::min(y + i, image.height() - 1)), width);
  for (int reach = 1; reach < cell; reach *= 2) {
    std::copy(highest.begin(), highest.end(), workspace.begin());
    raise(highest.data(), workspace.data() + reach, width);
  }
}

}  // namespace

HighlightMask::HighlightMask(const ImagePyramid& pyramid, const ExtractorSettings& settings)
    : cell_(pyramid.level(0).width() < 800 ? 4 : 8),
      specular_threshold_(settings.specular_threshold),
      contrast_(static_cast<std::uint32_t>(std::lround(settings.specular_contrast * 256))),
      highlights_(pyramid.level(0).width(), pyramid.level(0).height(), cell_),
      brightness_(pyramid.level(pyramid.levels() - 1)),
      highest_(pyramid.level(0).stride()),
      workspace_(highest_.size() + 8),
      tissue_(highlights_.columns()) {}

void HighlightMask::update(const ImagePyramid& pyramid, int dark_threshold) {
  brightness_.update(pyramid.level(pyramid.levels() - 1), dark_threshold);
  highlights_.clear();
  bool any = false;
  for (int r = 0; r < highlights_.rows(); ++r) {
    highestOfCells(pyramid.level(0), r * cell_, cell_, workspace_, highest_);
    brightness_.sampleRow((r + 0.5) / highlights_.rows(), tissue_);
    for (int c = 0; c < highlights_.columns(); ++c) {
      const auto limit = static_cast<int>((tissue_[c] * contrast_) >> 16);
      if (highest_[c * cell_] < std::min(limit, specular_threshold_)) continue;
      highlights_.mark(c, r);
      any = true;
    }
  }
  if (any) highlights_.propagate();
}

}  // namespace depthscope::slam
