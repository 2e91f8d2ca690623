#pragma once
#include <cstdint>

#include "recon/grid.hpp"

namespace depthscope::recon {

/// Zero-mean normalized cross-correlation of square windows: blind to gain and offset, for the
/// light moves with the scope. Window sums are whole numbers, so the result does not depend on
/// their order.
class Correlator {
 public:
  static constexpr int kSmall = 2, kLarge = 3;  // the radii of windows that there are [px]

  /// Takes the reference picture; windows have (2 radius + 1)^2 pixels, at the border the outermost
  /// ones count repeatedly. Texture below `noise` [grey levels], of the sensor and of compression,
  /// does not correlate.
  void setReference(const Grid<std::uint8_t>& reference, const Grid<std::uint8_t>& usable,
                    int radius, float noise);
  /// Cost of each pixel of `warped` against the reference: 255 (1 - ZNCC), ZNCC below 0 taken as 0;
  /// 255 where the pixel of either is not usable.
  void cost(const Grid<std::uint8_t>& warped, const Grid<std::uint8_t>& usable,
            Grid<std::uint8_t>& out);

 private:
  void columnSums(const Grid<std::uint8_t>& picture, int y);

  Grid<std::uint8_t> reference_, usable_;
  std::vector<std::uint8_t> nothing_;  // a row of zeros
  int radius_ = kSmall;
  float noise_ = 0;  // of a window's variance, as the sums below scale it
  Grid<std::int32_t> sum_;
  Grid<float> inverse_deviation_;
  // Sums over the window's rows, of each column: with `radius_` cells more on either side.
  std::vector<std::int32_t> luma_, squares_, products_;
};

}  // namespace depthscope::recon
