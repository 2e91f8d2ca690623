#pragma once
#include <cstdint>

#include "recon/dense/grid.hpp"
#include "types/image_view.hpp"

namespace depthscope::recon {

/// The luma of a keyframe, reduced by a whole factor, in the geometry of the lens.
struct KeyframePicture {
  std::int64_t frame = -1;  // number of the frame, as in SparseCloud::keyframe_frames
  Grid<std::uint8_t> luma;
};

/// Factor by which pictures `width` wide are reduced so that they come near `wanted` [px].
int reductionFactor(int width, int wanted);

/// Means over factor x factor pixels; what is left over at the right and bottom is cut off. `out`
/// keeps its storage.
void reducePicture(const GrayView& luma, int factor, Grid<std::uint8_t>& out);

}  // namespace depthscope::recon
