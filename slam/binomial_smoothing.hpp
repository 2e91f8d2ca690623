#pragma once
#include <cstdint>
#include <vector>

#include "slam/image_buffer.hpp"
#include "slam/simd_dispatch.hpp"

namespace depthscope::slam {

/// Smoothing with the 3x3 binomial kernel (1 2 1) x (1 2 1) / 16, which is a Gaussian of sigma 0.71
/// px; twice is sigma 1, and so on. Each of its four averages rounds up. The border is repeated
/// outwards.
class BinomialSmoothing {
 public:
  /// For pictures up to `width` wide.
  explicit BinomialSmoothing(int width);
  /// `out` has the size of `source` and is not the same picture.
  void operator()(const ImageBuffer& source, ImageBuffer& out, SimdPath path);

 private:
  std::vector<std::uint8_t> row_;  // one vertically smoothed row
};

}  // namespace depthscope::slam
