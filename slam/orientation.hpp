#pragma once
#include <cstddef>
#include <cstdint>

namespace depthscope::slam {

/// Radius of the patch that orients and describes a keypoint [px of its level].
inline constexpr int kPatchRadius = 15;

/// Direction from `centre` to the intensity centroid of the disc of kPatchRadius around it [rad,
/// from +x towards +y] (Rosin 1999; Rublee et al. 2011, section 3.2). Reads 16 px to the right of
/// `centre`, else 15.
float intensityCentroidAngle(const std::uint8_t* centre, std::ptrdiff_t stride);

}  // namespace depthscope::slam
