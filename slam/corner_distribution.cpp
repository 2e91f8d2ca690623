#include "slam/corner_distribution.hpp"

#include <algorithm>
#include <array>

namespace depthscope::slam {
namespace {

// Corners to choose from, times the number wanted: the weakest of a rich level are noise, and even
// spread is not worth them.
constexpr int kSpare = 2;

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
  int spacing = 2;
  while (spacing < 2 * std::max(width_, height_) &&
         (width_ / (spacing / 2) / 3 + 1) * (height_ / (spacing / 2) / 3 + 1) >= wanted)
    ++spacing;
  return spacing;
}

/// Takes corners in order, each covering the square of about +-`spacing` around it.
void CornerDistribution::cover(int spacing, int at_most) {
  const int cell = std::max(1, spacing / 2);
  const int reach = spacing >= 2 ? 2 : spacing;
  const int columns = width_ / cell + 1 + 2 * reach, rows = height_ / cell + 1 + 2 * reach;
  std::fill_n(covered_.begin(), columns * rows, std::uint8_t{0});
  chosen_.clear();
  for (std::uint32_t i = 0; i < sorted_.size(); ++i) {
    std::uint8_t* corner = covered_.data() + sorted_[i].y / cell * columns + sorted_[i].x / cell;
    if (corner[reach * columns + reach] != 0) continue;
    chosen_.push_back(i);
    if (static_cast<int>(chosen_.size()) > at_most) return;
    for (int r = 0; r <= 2 * reach; ++r)
      std::fill_n(corner + r * columns, 2 * reach + 1, std::uint8_t{1});
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
  int enough = 0, too_wide = tooWideFor(wanted);
  while (too_wide - enough > 1) {
    const int spacing = (enough + too_wide) / 2;
    cover(spacing, wanted);
    (static_cast<int>(chosen_.size()) >= wanted ? enough : too_wide) = spacing;
  }
  cover(enough, wanted);
  chosen_.resize(wanted);
  for (const std::uint32_t i : chosen_) corners.push_back(sorted_[i]);
}

}  // namespace depthscope::slam
