#include "slam/cell_distance.hpp"

#include <cmath>

namespace depthscope::slam {
namespace {

using Byte = std::uint8_t;

Byte beyond(Byte distance, int step) {
  return static_cast<Byte>(std::min(distance + step, 255));
}

/// Lets one row know what its finished neighbour row knows.
void relaxFrom(const Byte* neighbour, int columns, Byte* row) {
  for (int c = 0; c < columns; ++c) {
    const Byte left = neighbour[std::max(c - 1, 0)];
    const Byte right = neighbour[std::min(c + 1, columns - 1)];
    const Byte nearest = std::min(beyond(neighbour[c], 3), beyond(std::min(left, right), 4));
    row[c] = std::min(row[c], nearest);
  }
}

}  // namespace

CellDistance::CellDistance(int width, int height, double cell)
    : cells_per_pixel_(1 / cell),
      pixels_per_step_(cell / 3),
      columns_(static_cast<int>(std::ceil(width / cell))),
      rows_(static_cast<int>(std::ceil(height / cell))),
      distance_(static_cast<std::size_t>(columns_) * rows_, kFar) {}

void CellDistance::propagate() {
  for (int r = 0; r < rows_; ++r) {
    Byte* row = distance_.data() + r * columns_;
    if (r > 0) relaxFrom(row - columns_, columns_, row);
    for (int c = 1; c < columns_; ++c) row[c] = std::min(row[c], beyond(row[c - 1], 3));
  }
  for (int r = rows_ - 1; r >= 0; --r) {
    Byte* row = distance_.data() + r * columns_;
    if (r + 1 < rows_) relaxFrom(row + columns_, columns_, row);
    for (int c = columns_ - 2; c >= 0; --c) row[c] = std::min(row[c], beyond(row[c + 1], 3));
  }
}

}  // namespace depthscope::slam
