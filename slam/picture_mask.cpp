#include "slam/picture_mask.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kSpecularCell = 4;  // [px] of full resolution
constexpr int kCoarseStep = 2;    // [px] of the coarsest level per cell of the surroundings

/// The brightest of each column of a row of cells. Behind the last column `highest` stays zero.
void highestOfRows(const ImageBuffer& image, int y, std::uint8_t* __restrict highest) {
  const std::uint8_t* rows[kSpecularCell];
  for (int i = 0; i < kSpecularCell; ++i) rows[i] = image.row(std::min(y + i, image.height() - 1));
  const std::uint8_t *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3];
  const int width = image.width();
  for (int x = 0; x < width; ++x) highest[x] = std::max(std::max(a[x], b[x]), std::max(c[x], d[x]));
}

enum Region : std::uint8_t { kBright, kDark, kOutside, kVisited, kInside };

}  // namespace

PictureMask::PictureMask(const ImagePyramid& pyramid, const ExtractorSettings& settings)
    : settings_(settings),
      specular_(pyramid.level(0).width(), pyramid.level(0).height(), kSpecularCell),
      surroundings_(pyramid.level(0).width(), pyramid.level(0).height(),
                    kCoarseStep * pyramid.scale(pyramid.levels() - 1)),
      brightness_(pyramid.level(pyramid.levels() - 1)),
      highest_(pyramid.level(0).stride()),
      tissue_(specular_.columns()),
      region_(static_cast<std::size_t>(surroundings_.columns()) * surroundings_.rows()) {
  flood_.reserve(region_.size());
}

void PictureMask::update(const ImagePyramid& pyramid) {
  const ImageBuffer& coarse = pyramid.level(pyramid.levels() - 1);
  brightness_.update(coarse, settings_.dark_threshold);
  findSpeculars(pyramid.level(0));
  findSurroundings(coarse);
}

/// A highlight is saturated, or stands out from the tissue around it by more than texture does.
void PictureMask::findSpeculars(const ImageBuffer& image) {
  specular_.clear();
  const auto contrast = static_cast<std::uint32_t>(std::lround(settings_.specular_contrast * 256));
  bool any = false;
  for (int r = 0; r < specular_.rows(); ++r) {
    highestOfRows(image, r * kSpecularCell, highest_.data());
    brightness_.sampleRow((r + 0.5) / specular_.rows(), tissue_);
    for (int c = 0; c < specular_.columns(); ++c) {
      const std::uint8_t* p = highest_.data() + c * kSpecularCell;
      const int high = std::max(std::max(p[0], p[1]), std::max(p[2], p[3]));
      const auto limit = static_cast<int>((tissue_[c] * contrast) >> 16);
      if (high < std::min(limit, settings_.specular_threshold)) continue;
      specular_.mark(c, r);
      any = true;
    }
  }
  if (any) specular_.propagate();
}

void PictureMask::floodFrom(int column, int row, std::uint8_t from, std::uint8_t to) {
  const int columns = surroundings_.columns(), rows = surroundings_.rows();
  const auto visit = [&](int c, int r) {
    if (c < 0 || r < 0 || c >= columns || r >= rows || region_[r * columns + c] != from) return;
    region_[r * columns + c] = to;
    flood_.push_back(r * columns + c);
  };
  flood_.clear();
  visit(column, row);
  for (std::size_t next = 0; next < flood_.size(); ++next) {
    const int c = flood_[next] % columns, r = flood_[next] / columns;
    visit(c - 1, r);
    visit(c + 1, r);
    visit(c, r - 1);
    visit(c, r + 1);
  }
}

void PictureMask::findSurroundings(const ImageBuffer& coarse) {
  surroundings_.clear();
  const int columns = surroundings_.columns(), rows = surroundings_.rows();
  for (int r = 0; r < rows; ++r) {
    const std::uint8_t* row = coarse.row(std::min(r * kCoarseStep, coarse.height() - 1));
    for (int c = 0; c < columns; ++c)
      region_[r * columns + c] =
          row[std::min(c * kCoarseStep, coarse.width() - 1)] <= settings_.dark_threshold ? kDark
                                                                                         : kBright;
  }
  for (int c = 0; c < columns; ++c) {
    floodFrom(c, 0, kDark, kOutside);
    floodFrom(c, rows - 1, kDark, kOutside);
  }
  for (int r = 0; r < rows; ++r) {
    floodFrom(0, r, kDark, kOutside);
    floodFrom(columns - 1, r, kDark, kOutside);
  }
  if (std::find(region_.begin(), region_.end(), kOutside) == region_.end()) return;
  // Dark tissue inside is of the view; and of what is left the largest piece is the view: towers
  // write text into the corners.
  for (std::uint8_t& cell : region_)
    if (cell == kDark) cell = kBright;
  std::size_t largest = 0;
  int seed = -1;
  for (int i = 0; i < columns * rows; ++i) {
    floodFrom(i % columns, i / columns, kBright, kVisited);
    if (flood_.size() <= largest) continue;
    largest = flood_.size();
    seed = i;
  }
  if (seed >= 0) floodFrom(seed % columns, seed / columns, kVisited, kInside);
  for (int i = 0; i < columns * rows; ++i)
    if (region_[i] != kInside) surroundings_.mark(i % columns, i / columns);
  surroundings_.propagate();
}

}  // namespace depthscope::slam
