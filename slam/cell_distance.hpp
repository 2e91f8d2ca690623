#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace depthscope::slam {

/// Distances from a set of marked cells, in a coarse grid over the picture.
class CellDistance {
 public:
  /// Cells of `cell` pixels of full resolution over a picture of width x height.
  CellDistance(int width, int height, double cell);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  void clear() { std::fill(distance_.begin(), distance_.end(), kFar); }
  void mark(int column, int row) { distance_[row * stride_ + column + 1] = 0; }
  /// Fills in the distances once all cells are marked (chamfer 3-4, Borgefors 1986).
  void propagate();
  /// Distance [px] of full resolution from (x, y) to the nearest marked cell, to within one cell;
  /// 85 cells is the farthest told.
  double at(double x, double y) const {
    const int c = std::min(static_cast<int>((x + 0.5) * cells_per_pixel_), columns_ - 1);
    const int r = std::min(static_cast<int>((y + 0.5) * cells_per_pixel_), rows_ - 1);
    return distance_[r * stride_ + c + 1] * pixels_per_step_;
  }

 private:
  static constexpr std::uint8_t kFar = 255;
  double cells_per_pixel_, pixels_per_step_;
  int columns_, rows_, stride_;
  std::vector<std::uint8_t> distance_;  // in thirds of a cell; rows with one far cell on each side
};

}  // namespace depthscope::slam
