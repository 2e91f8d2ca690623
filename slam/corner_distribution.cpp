#include "slam/corner_distribution.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace depthscope::slam {
namespace {

// Corners to choose from, times the number wanted: the weakest of a rich level are noise, and even
// spread is not worth them.
constexpr int kSpare = 2;
constexpr int kLeastSpacing = 4;  // [half pixels]: cells of one pixel

}  // namespace

CornerDistribution::CornerDistribution(int width, int height, int capacity)
    : covered_((static_cast<std::size_t>(width) + 8) * (static_cast<std::size_t>(height) + 8)) {
  sorted_.reserve(capacity);
  chosen_.reserve(capacity);
}

void CornerDistribution::sortByScore(const std::vector<Corner>& corners) {
  std::array<std::uint32_t, 257> begin{};
  for (const Corner& c : corners) ++begin[256 - c.score];
  for (int i = 1; i <= 256; ++i) begin[i] += begin[i - 1];
  sorted_.resize(corners.size());
  for (const Corner& c : corners) sorted_[begin[255 - c.score]++] = c;
}

/// The least spacing at which fewer than `wanted` corners can be chosen: they lie three cells
/// apart.
int CornerDistribution::tooWideFor(int wanted) const {
  int spacing = kLeastSpacing + 1;
  while (spacing < 4 * std::max(width_, height_) &&
         (4 * width_ / spacing / 3 + 1) * (4 * height_ / spacing / 3 + 1) >= wanted)
    ++spacing;
  return spacing;
}

/// Takes corners in order, each covering the square of about +-`spacing` half pixels around it,
/// until there are more than `at_most`.
void CornerDistribution::cover(int spacing, int at_most) {
  constexpr int kReach = 2;  // cells to each side
  const float cells_per_pixel = 2.0F * kReach / static_cast<float>(spacing);
  const auto cellOf = [&](int x) {
    return static_cast<int>((static_cast<float>(x) + 0.5F) * cells_per_pixel);
  };
  const int columns = cellOf(width_ - 1) + 1 + 2 * kReach;
  const int rows = cellOf(height_ - 1) + 1 + 2 * kReach;
  std::fill_n(covered_.begin(), columns * rows, std::uint8_t{0});
  chosen_.clear();
  for (std::uint32_t i = 0; i < sorted_.size(); ++i) {
    // Upper left of the cells around the corner's: the grid has kReach more on each side.
    std::uint8_t* first = covered_.data() + cellOf(sorted_[i].y) * columns + cellOf(sorted_[i].x);
    if (first[kReach * columns + kReach] != 0) continue;
    chosen_.push_back(i);
    if (static_cast<int>(chosen_.size()) > at_most) return;
    for (int r = 0; r <= 2 * kReach; ++r)
      std::fill_n(first + r * columns, 2 * kReach + 1, std::uint8_t{1});
  }
}

void CornerDistribution::reduce(int wanted, int width, int height, std::vector<Corner>& corners) {
  width_ = width;
  height_ = height;
  sortByScore(corners);
  if (static_cast<int>(corners.size()) <= wanted) {
    corners.assign(sorted_.begin(), sorted_.end());
    return;
  }
  corners.clear();
  if (wanted <= 0) return;
  sorted_.resize(std::min(sorted_.size(), static_cast<std::size_t>(kSpare) * wanted));
  // The widest spacing that still gives `wanted`: more corners come with less spacing.
  int enough = kLeastSpacing, too_wide = tooWideFor(wanted);
  while (too_wide - enough > 1) {
    const int spacing = (enough + too_wide) / 2;
    cover(spacing, wanted);
    (static_cast<int>(chosen_.size()) >= wanted ? enough : too_wide) = spacing;
  }
  cover(enough, wanted);
  // So dense that no spacing leaves enough: the strongest.
  if (static_cast<int>(chosen_.size()) < wanted) {
    chosen_.resize(wanted);
    std::iota(chosen_.begin(), chosen_.end(), 0U);
  }
  chosen_.resize(wanted);
  for (const std::uint32_t i : chosen_) corners.push_back(sorted_[i]);
}

}  // namespace depthscope::slam
