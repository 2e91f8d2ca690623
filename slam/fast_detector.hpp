#pragma once
#include <cstdint>
#include <vector>

#include "slam/image_area.hpp"
#include "slam/image_buffer.hpp"
#include "slam/simd_dispatch.hpp"

namespace depthscope::slam {

/// A corner of one pyramid level.
struct Corner {
  std::int16_t x = 0, y = 0;  // [px] of its level
  std::uint8_t score = 0;     // [grey levels]
};

/// FAST-9/16 over one picture, vectorised over the pixels of a row. The score of a pixel is the
/// largest s such that 9 contiguous pixels of the 16 around it (radius 3) are all brighter, or all
/// darker, than it by at least s; it is a corner at threshold t when its score is above t (Rosten &
/// Drummond 2006).
class FastDetector {
 public:
  /// For pictures up to `width` wide.
  explicit FastDetector(int width);

  /// Appends to `corners`, in the order of rows, the pixels of `area` whose score is above
  /// `threshold`
  /// (>= 1) and a maximum of its 3x3 neighbourhood; of equal neighbours the first counts. `area`
  /// keeps 4 px from the picture's border. Does not allocate while `corners` has room for a quarter
  /// of the pixels.
  void detect(const ImageBuffer& image, int threshold, const Area& area, SimdPath path,
              std::vector<Corner>& corners);

 private:
  std::uint8_t* scoreRow(int y) { return scores_.data() + (y % 3) * stride_; }

  std::ptrdiff_t stride_;
  std::vector<std::uint8_t> scores_;  // of three rows
  std::vector<std::uint8_t> row_;     // workspace: candidates, then maxima, of one row
};

}  // namespace depthscope::slam
