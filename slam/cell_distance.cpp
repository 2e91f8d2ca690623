#include "slam/cell_distance.hpp"

#include <cmath>

namespace depthscope::slam {
namespace {

using Byte = std::uint8_t;

/// distance + step, but not above 255.
Byte beyond(Byte distance, Byte step) {
  return static_cast<Byte>(std::min(distance, static_cast<Byte>(255 - step)) + step);
}

/// Lets one row know what its finished neighbour row knows. Both have a cell more on each side.
void relaxFrom(const Byte* __restrict neighbour, int columns, Byte* __restrict row) {
  for (int c = 0; c < columns; ++c) {
    const Byte straight = beyond(neighbour[c], 3);
    const Byte diagonal = beyond(std::min(neighbour[c - 1], neighbour[c + 1]), 4);
    row[c] = std::min(row[c], std::min(straight, diagonal));
  }
}

}  // namespace

CellDistance::CellDistance(int width, int height, double cell)
    : cells_per_pixel_(1 / cell),
      pixels_per_step_(cell / 3),
      columns_(static_cast<int>(std::ceil(width / cell))),
      rows_(static_cast<int>(std::ceil(height / cell))),
      stride_(columns_ + 2),
      distance_(static_cast<std::size_t>(stride_) * rows_, kFar) {}

void CellDistance::propagate() {
  for (int r = 0; r < rows_; ++r) {
    Byte* row = distance_.data() + r * stride_ + 1;
    if (r > 0) relaxFrom(row - stride_, columns_, row);
    for (int c = 1; c < columns_; ++c) row[c] = std::min(row[c], beyond(row[c - 1], 3));
  }
  for (int r = rows_ - 1; r >= 0; --r) {
    Byte* row = distance_.data() + r * stride_ + 1;
    if (r + 1 < rows_) relaxFrom(row + stride_, columns_, row);
    for (int c = columns_ - 2; c >= 0; --c) row[c] = std::min(row[c], beyond(row[c + 1], 3));
  }
}

}  // namespace depthscope::slam
