#pragma once
#include <cstdint>

#include "recon/grid.hpp"
#include "recon/pinhole_view.hpp"
#include "types/pose.hpp"

namespace depthscope::recon {

inline constexpr int kDepthLevel = 1;  // of the pinhole view, that depth maps have the size of

/// What multi-view stereo says about a view, at level `kDepthLevel` of the pinhole view.
struct DepthMap {
  Grid<float> inverse_depth;      // along the optical axis [1 / map unit]; 0: unknown
  Grid<std::uint8_t> confidence;  // 1..255; 0: unknown
  Grid<float> slant;              // unit surface normal times the ray (x / z, y / z, 1)
  float precision = 0;  // inverse depth that one pixel of disparity is worth [1 / map unit]
};

/// Fills `slant` from the depths' gradient, and forgets depths of surfaces tilted by more than
/// `max_tilt_deg` from the line of sight: bridges from near to far tissue.
void measureSlant(DepthMap& map, const PinholeLevel& level, double max_tilt_deg);

}  // namespace depthscope::recon
