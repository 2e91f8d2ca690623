#pragma once
#include <cstdint>
#include <vector>

#include "slam/cell_distance.hpp"
#include "slam/image_pyramid.hpp"
#include "slam/local_brightness.hpp"
#include "slam/slam_settings.hpp"

namespace depthscope::slam {

/// Where corners are not of the tissue: on and around saturated highlights, which move with light
/// and scope, and outside or across the edge of the round field of view, which stands still in the
/// picture.
class PictureMask {
 public:
  PictureMask(const ImagePyramid& pyramid, const ExtractorSettings& settings);

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

  ExtractorSettings settings_;
  CellDistance specular_;
  CellDistance surroundings_;
  LocalBrightness brightness_;
  std::vector<std::uint8_t> highest_;  // workspace: the brightest of each column of a cell
  std::vector<std::uint16_t> tissue_;  // workspace: brightness_ along a row of cells
  std::vector<std::uint8_t> region_;   // workspace: what each cell of surroundings_ is
  std::vector<std::int32_t> flood_;    // workspace: cells to visit
};

}  // namespace depthscope::slam
