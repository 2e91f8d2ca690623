#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "slam/image_buffer.hpp"

namespace depthscope::slam {

/// How bright the tissue is around a place, highlights and the dark surroundings of the view aside:
/// a percentile over a neighbourhood of about a fifth of the picture's width.
class LocalBrightness {
 public:
  /// For pictures of the size of `coarse`.
  explicit LocalBrightness(const ImageBuffer& coarse);

  /// Pixels at or below `dark_threshold` do not count.
  void update(const ImageBuffer& coarse, int dark_threshold);

  /// Brightness [grey levels, times 256] along the picture row at `v` (0: top edge, 1: bottom
  /// edge), at the middles of `out.size()` equal pieces of the row. Where nothing is lit it is that
  /// of white.
  void sampleRow(double v, std::vector<std::uint16_t>& out) const;

 private:
  static constexpr int kColumns = 16;
  static constexpr int kBins = 64;
  using Histogram = std::array<std::uint16_t, kBins>;

  void countBlocks(const ImageBuffer& coarse, int dark_threshold);
  std::uint16_t percentileAround(int column, int row) const;

  int rows_;
  std::vector<Histogram> histograms_;      // of each block
  std::vector<std::uint16_t> brightness_;  // at each block's middle, times 256
};

}  // namespace depthscope::slam
