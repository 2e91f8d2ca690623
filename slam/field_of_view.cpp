#include "slam/field_of_view.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kStep = 2;   // [px of the coarsest level] per cell
constexpr int kReach = 4;  // [cells] around the first and last one seen, where an end is looked for
constexpr int kLit = 4;    // pixels in a row that end the surroundings: noise lights up one of them
constexpr float kEdge = 0.006f;  // width of the view's blurred edge, of the picture's height

enum Region : std::uint8_t { kBright, kDark, kSurroundings, kPiece, kView };

}  // namespace

FieldOfView::FieldOfView(const ImagePyramid& pyramid)
    : width_(pyramid.level(0).width()),
      height_(pyramid.level(0).height()),
      cell_(kStep * pyramid.scale(pyramid.levels() - 1)),
      surroundings_(width_, height_, cell_),
      bounds_{0, 0, width_, height_},
      region_(static_cast<std::size_t>(surroundings_.columns()) * surroundings_.rows()) {
  visited_.reserve(region_.size());
}

void FieldOfView::update(const ImagePyramid& pyramid, int dark_threshold) {
  dark_threshold_ = dark_threshold;
  classify(pyramid.level(pyramid.levels() - 1));
  surroundings_.clear();
  bounds_ = {0, 0, width_, height_};
  if (!floodSurroundings()) return;
  keepLargestPiece();
  markSurroundings();
}

void FieldOfView::classify(const ImageBuffer& coarse) {
  const int columns = surroundings_.columns(), rows = surroundings_.rows();
  for (int r = 0; r < rows; ++r) {
    const std::uint8_t* row = coarse.row(std::min(r * kStep, coarse.height() - 1));
    for (int c = 0; c < columns; ++c)
      region_[r * columns + c] =
          row[std::min(c * kStep, coarse.width() - 1)] <= dark_threshold_ ? kDark : kBright;
  }
}

int FieldOfView::flood(int column, int row, std::uint8_t from, std::uint8_t to) {
  const int columns = surroundings_.columns(), rows = surroundings_.rows();
  const auto visit = [&](int c, int r) {
    if (c < 0 || r < 0 || c >= columns || r >= rows || region_[r * columns + c] != from) return;
    region_[r * columns + c] = to;
    visited_.push_back(r * columns + c);
  };
  visited_.clear();
  visit(column, row);
  for (std::size_t next = 0; next < visited_.size(); ++next) {
    const int c = visited_[next] % columns, r = visited_[next] / columns;
    visit(c - 1, r);
    visit(c + 1, r);
    visit(c, r - 1);
    visit(c, r + 1);
  }
  return static_cast<int>(visited_.size());
}

bool FieldOfView::floodSurroundings() {
  const int columns = surroundings_.columns(), rows = surroundings_.rows();
  int found = 0;
  for (int c = 0; c < columns; ++c)
    found += flood(c, 0, kDark, kSurroundings) + flood(c, rows - 1, kDark, kSurroundings);
  for (int r = 0; r < rows; ++r)
    found += flood(0, r, kDark, kSurroundings) + flood(columns - 1, r, kDark, kSurroundings);
  return found > 0;
}

void FieldOfView::keepLargestPiece() {
  // Dark tissue inside is part of the view.
  std::replace(region_.begin(), region_.end(), std::uint8_t{kDark}, std::uint8_t{kBright});
  const int columns = surroundings_.columns(), cells = static_cast<int>(region_.size());
  int largest = 0, seed = -1;
  for (int i = 0; i < cells; ++i) {
    const int size = flood(i % columns, i / columns, kBright, kPiece);
    if (size <= largest) continue;
    largest = size;
    seed = i;
  }
  if (seed >= 0) flood(seed % columns, seed / columns, kPiece, kView);
}

void FieldOfView::markSurroundings() {
  const int columns = surroundings_.columns(), rows = surroundings_.rows();
  int left = columns, top = rows, right = 0, bottom = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (region_[r * columns + c] != kView) {
        surroundings_.mark(c, r);
        continue;
      }
      left = std::min(left, c);
      right = std::max(right, c + 1);
      top = std::min(top, r);
      bottom = std::max(bottom, r + 1);
    }
  surroundings_.propagate();
  if (right == 0) left = top = 0;  // all dark
  const auto pixel = [&](int cells, int end) {
    return std::min(static_cast<int>(std::ceil(cells * cell_)), end);
  };
  bounds_ = {static_cast<int>(left * cell_), static_cast<int>(top * cell_), pixel(right, width_),
             pixel(bottom, height_)};
}

ViewOutline FieldOfView::outline(const ImagePyramid& pyramid) const {
  ViewOutline outline;
  for (int band = 0; band < ViewOutline::bands; ++band) {
    const int y = static_cast<int>((band + 0.5) * height_ / ViewOutline::bands);
    outline.spans[static_cast<std::size_t>(band)] = spanAt(pyramid.level(0).row(y), y);
  }
  return outline;
}

/// Which cells of a row are seen tells where to look for the ends; its pixels tell where they are.
ViewOutline::Span FieldOfView::spanAt(const std::uint8_t* row, double y) const {
  const int columns = surroundings_.columns();
  const auto seen = [&](int c) { return surroundings_.at((c + 0.5) * cell_ - 0.5, y) > 0; };
  int first = 0, last = columns - 1;
  while (first <= last && !seen(first)) ++first;
  while (last >= first && !seen(last)) --last;
  if (first > last) return {0, 0};
  const auto pixel = [&](int c) { return std::clamp(static_cast<int>(c * cell_), 0, width_ - 1); };
  // A cell is one look at the coarsest level, not quite in this row: the end is some cells around.
  int left = pixel(first - kReach), right = pixel(last + 1 + kReach);
  const int left_most = std::min(pixel(first + kReach), width_ - kLit);
  const int right_least = std::max(pixel(last + 1 - kReach), kLit - 1);
  const auto lit = [&](int begin) {
    return std::all_of(row + begin, row + begin + kLit,
                       [&](std::uint8_t grey) { return grey > dark_threshold_; });
  };
  while (left < left_most && !lit(left)) ++left;
  while (right > right_least && !lit(right + 1 - kLit)) --right;
  const float margin = kEdge * static_cast<float>(height_);
  ViewOutline::Span span;
  if (left > 0) span.left = static_cast<float>(left) + margin;
  if (right < width_ - 1) span.right = static_cast<float>(right + 1) - margin;
  return span;
}

}  // namespace depthscope::slam
