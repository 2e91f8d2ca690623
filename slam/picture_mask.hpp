#pragma once
#include <cstdint>
#include <vector>

#include "slam/image_pyramid.hpp"

namespace depthscope::slam {

/// Distances from a set of marked cells, in a coarse grid over the picture.
class CellDistance {
 public:
  /// Cells of `cell` pixels of full resolution over a picture of width x height.
  CellDistance(int width, int height, double cell);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  void clear() { distance_.assign(distance_.size(), kFar); }
  void mark(int column, int row) { distance_[row * columns_ + column] = 0; }
  bool isMarked(int column, int row) const { return distance_[row * columns_ + column] == 0; }
  /// Fills in the distances once all cells are marked (chamfer 3-4, Borgefors 1986).
  void propagate();
  /// Distance [px] of full resolution from (x, y) to the nearest marked cell, to within one cell.
  double at(double x, double y) const {
    const int c = static_cast<int>((x + 0.5) / cell_), r = static_cast<int>((y + 0.5) / cell_);
    return distance_[(r < rows_ ? r : rows_ - 1) * columns_ + (c < columns_ ? c : columns_ - 1)] *
           (cell_ / 3);
  }

 private:
  static constexpr std::uint8_t kFar = 255;  // 85 cells
  double cell_;
  int columns_, rows_;
  std::vector<std::uint8_t> distance_;  // in thirds of a cell
};

/// Where corners are not of the tissue: on and around saturated highlights, which move with light
/// and scope, and outside or across the edge of the round field of view, which stands still in the
/// picture.
class PictureMask {
 public:
  /// specular_threshold, dark_threshold: as in ExtractorSettings.
  PictureMask(const ImagePyramid& pyramid, int specular_threshold, int dark_threshold);

  /// Finds both areas in the pyramid's picture.
  void update(const ImagePyramid& pyramid);

  /// Distance [px] at full resolution from (x, y) to the nearest highlight.
  double toSpecular(double x, double y) const { return specular_.at(x, y); }
  /// Distance [px] at full resolution from (x, y) to the dark surroundings of the field of view.
  double toSurroundings(double x, double y) const { return surroundings_.at(x, y); }

 private:
  void findSpeculars(const ImageBuffer& image);
  void findSurroundings(const ImageBuffer& coarse);
  void floodFrom(int column, int row, std::uint8_t from, std::uint8_t to);

  int specular_threshold_, dark_threshold_;
  CellDistance specular_;
  CellDistance surroundings_;
  std::vector<std::uint8_t> highest_;  // workspace: the brightest of each column of four rows
  std::vector<std::uint8_t> region_;   // workspace: what each cell of surroundings_ is
  std::vector<std::int32_t> flood_;    // workspace: cells to visit
};

}  // namespace depthscope::slam
