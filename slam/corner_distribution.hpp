#pragma once
#include <cstdint>
#include <vector>

#include "slam/fast_detector.hpp"

namespace depthscope::slam {

/// Chooses corners spread evenly over a picture: adaptive non-maximal suppression by square
/// covering (Bailo et al. 2018, "Efficient adaptive non-maximal suppression algorithms for
/// homogeneous spatial keypoint distribution").
class CornerDistribution {
 public:
  /// For pictures up to width x height and up to `capacity` corners at a time.
  CornerDistribution(int width, int height, int capacity);

  /// Reduces the corners of a picture of width x height to at most `wanted`, the strongest of each
  /// neighbourhood, strongest first; of equally strong ones those that come first.
  void reduce(int wanted, int width, int height, std::vector<Corner>& corners);

 private:
  void sortByScore(const std::vector<Corner>& corners);
  int tooWideFor(int wanted) const;
  void cover(int spacing, int at_most);

  int width_ = 0, height_ = 0;         // of the picture at work
  std::vector<Corner> sorted_;         // strongest first, then as they came
  std::vector<std::uint32_t> chosen_;  // positions in sorted_
  std::vector<std::uint8_t> covered_;  // cells of the current try
};

}  // namespace depthscope::slam
