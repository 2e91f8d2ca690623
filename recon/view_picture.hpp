#pragma once
#include <cstdint>

#include "recon/grid.hpp"
#include "types/color.hpp"
#include "types/image_view.hpp"

namespace depthscope::recon {

/// The picture of a view, in the geometry of the lens.
struct ViewPicture {
  std::int64_t frame = -1;  // number of the frame, as in SparseCloud::view_frames
  Grid<std::uint8_t> luma;  // reduced by a whole factor
  Grid<Rgb> color;          // of ColorReduction's size
};

/// Whole factor by which pictures `width` wide are reduced so that `wanted` pixels or more are
/// left.
int reductionFactor(int width, int wanted);

/// Copies a colour picture. `out` keeps its storage.
void copyColor(const RgbView& color, Grid<Rgb>& out);

/// Means over factor x factor pixels; what is left over at the right and bottom is cut off. `out`
/// keeps its storage.
void reducePicture(const GrayView& luma, int factor, Grid<std::uint8_t>& out);

}  // namespace depthscope::recon
