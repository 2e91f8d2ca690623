#pragma once
#include <cstdint>
#include <vector>

#include "slam/cell_distance.hpp"
#include "slam/image_pyramid.hpp"
#include "slam/local_brightness.hpp"
#include "slam/slam_settings.hpp"

namespace depthscope::slam {

/// Where specular highlights are: they move with light and scope, not with the tissue, and their
/// corners are the strongest of the picture.
class HighlightMask {
 public:
  /// For pictures of the size of `pyramid`.
  HighlightMask(const ImagePyramid& pyramid, const ExtractorSettings& settings);

  /// Finds the highlights of the pyramid's picture: what is saturated, or stands out from the
  /// tissue around it by more than texture does.
  void update(const ImagePyramid& pyramid, int dark_threshold);

  /// Distance [px] at full resolution from (x, y) to the nearest highlight, to within a cell of 4
  /// px (8 px in pictures 800 px wide or more).
  double distance(double x, double y) const { return highlights_.at(x, y); }

 private:
  int cell_;  // [px]
  int specular_threshold_;
  std::uint32_t contrast_;  // times 256
  CellDistance highlights_;
  LocalBrightness brightness_;
  std::vector<std::uint8_t> highest_, workspace_;  // a row of pixels each
  std::vector<std::uint16_t> tissue_;              // brightness of the tissue at a row of cells
};

}  // namespace depthscope::slam
