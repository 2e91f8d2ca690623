#pragma once
#include <cstdint>
#include <vector>

#include "slam/image_buffer.hpp"
#include "slam/simd_dispatch.hpp"

namespace depthscope::slam {

/// Gaussian smoothing, 7x7, sigma 2 px, in fixed point; the border is repeated outwards. BRIEF
/// compares single pixels, which only smoothing makes robust to noise (Calonder et al. 2010).
class GaussianBlur {
 public:
  /// For pictures up to `width` wide.
  explicit GaussianBlur(int width);
  /// `out` has the size of `source` and is not the same picture.
  void operator()(const ImageBuffer& source, ImageBuffer& out, SimdPath path);

 private:
  std::vector<std::uint8_t> row_;  // one vertically smoothed row with kRadius pixels on each side
};

}  // namespace depthscope::slam
