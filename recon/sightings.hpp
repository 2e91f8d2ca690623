#pragma once
#include <vector>

#include "recon/pinhole_view.hpp"
#include "types/sparse_cloud.hpp"

namespace depthscope::recon {

/// Who sees what, point by point: the keyframes what they are known to see, the other views what
/// lies in their picture (at `level`) and was seen by a keyframe from nearly the same direction and
/// distance, so that nothing is likely to stand before it.
std::vector<Sighting> sightingsOfAllViews(const SparseCloud& cloud, const PinholeLevel& level);

}  // namespace depthscope::recon
