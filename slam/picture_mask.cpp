#include "slam/picture_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace depthscope::slam {
namespace {

constexpr int kSpecularCell = 4;  // [px] of full resolution
constexpr int kCoarseStep = 2;    // [px] of the coarsest level per cell of the surroundings

enum Region : std::uint8_t { kBright, kDark, kOutside, kVisited, kInside };

}  // namespace

CellDistance::CellDistance(int width, int height, double cell)
    : cell_(cell),
      columns_(static_cast<int>(std::ceil(width / cell))),
      rows_(static_cast<int>(std::ceil(height / cell))),
      distance_(static_cast<std::size_t>(columns_) * rows_, kFar) {}

void CellDistance::propagate() {
  const auto relax = [](std::uint8_t& d, std::uint8_t neighbour, int step) {
    d = static_cast<std::uint8_t>(std::min<int>(d, neighbour + step));
  };
  for (int r = 0; r < rows_; ++r) {
    std::uint8_t* row = distance_.data() + r * columns_;
    for (int c = 0; r > 0 && c < columns_; ++c) {
      const std::uint8_t* above = row + c - columns_;
      relax(row[c], above[0], 3);
      if (c > 0) relax(row[c], above[-1], 4);
      if (c + 1 < columns_) relax(row[c], above[1], 4);
    }
    for (int c = 1; c < columns_; ++c) relax(row[c], row[c - 1], 3);
  }
  for (int r = rows_ - 1; r >= 0; --r) {
    std::uint8_t* row = distance_.data() + r * columns_;
    for (int c = 0; r + 1 < rows_ && c < columns_; ++c) {
      const std::uint8_t* below = row + c + columns_;
      relax(row[c], below[0], 3);
      if (c > 0) relax(row[c], below[-1], 4);
      if (c + 1 < columns_) relax(row[c], below[1], 4);
    }
    for (int c = columns_ - 2; c >= 0; --c) relax(row[c], row[c + 1], 3);
  }
}

PictureMask::PictureMask(const ImagePyramid& pyramid, int specular_threshold, int dark_threshold)
    : specular_threshold_(specular_threshold),
      dark_threshold_(dark_threshold),
      specular_(pyramid.level(0).width(), pyramid.level(0).height(), kSpecularCell),
      surroundings_(pyramid.level(0).width(), pyramid.level(0).height(),
                    kCoarseStep * pyramid.scale(pyramid.levels() - 1)),
      highest_(pyramid.level(0).stride()),
      region_(static_cast<std::size_t>(surroundings_.columns()) * surroundings_.rows()) {
  flood_.reserve(region_.size());
}

void PictureMask::update(const ImagePyramid& pyramid) {
  findSpeculars(pyramid.level(0));
  findSurroundings(pyramid.level(pyramid.levels() - 1));
}

void PictureMask::findSpeculars(const ImageBuffer& image) {
  specular_.clear();
  const auto below = static_cast<std::uint8_t>(std::clamp(specular_threshold_ - 1, 0, 255));
  bool any = false;
  for (int r = 0; r < specular_.rows(); ++r) {
    const std::uint8_t* rows[kSpecularCell];
    for (int i = 0; i < kSpecularCell; ++i)
      rows[i] = image.row(std::min(r * kSpecularCell + i, image.height() - 1));
    for (int x = 0; x < image.width(); ++x) {
      const std::uint8_t high =
          std::max(std::max(rows[0][x], rows[1][x]), std::max(rows[2][x], rows[3][x]));
      highest_[x] = static_cast<std::uint8_t>(std::max(high, below) - below);
    }
    for (int c = 0; c < specular_.columns(); ++c) {
      std::uint32_t saturated = 0;  // behind the last pixel highest_ stays zero
      std::memcpy(&saturated, highest_.data() + c * kSpecularCell, sizeof saturated);
      if (saturated == 0) continue;
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
          row[std::min(c * kCoarseStep, coarse.width() - 1)] <= dark_threshold_ ? kDark : kBright;
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
