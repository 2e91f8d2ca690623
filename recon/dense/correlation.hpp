#pragma once
#include <cstdint>

#include "recon/dense/grid.hpp"

namespace depthscope::recon {

/// Zero-mean normalized cross-correlation of square windows: blind to gain and offset, for the
/// light moves with the scope. Window sums are whole numbers, so the result does not depend on
/// their order.
class Correlator {
 public:
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
  template <class Add, class Subtract>
  void columnSums(int y, const Add& add, const Subtract& subtract,
                  std::vector<std::int32_t>& columns) const;
  void sumLuma(const Grid<std::uint8_t>& a, int y, std::vector<std::int32_t>& columns) const;
  void sumProducts(const Grid<std::uint8_t>& a, const Grid<std::uint8_t>& b, int y,
                   std::vector<std::int32_t>& columns) const;
  void windowSums(const std::vector<std::int32_t>& columns, std::vector<std::int32_t>& out) const;

  Grid<std::uint8_t> reference_, usable_;
  int radius_ = 2;
  float noise_ = 0;  // of a window's variance, as the sums below scale it
  Grid<std::int32_t> sum_;
  Grid<float> inverse_deviation_;
  // Rows of sums: over the columns of the window, then over the window.
  std::vector<std::int32_t> column_, column_squares_, column_products_;
  std::vector<std::int32_t> window_, window_squares_, window_products_;
};

}  // namespace depthscope::recon
