#pragma once
#include <cstdint>

namespace depthscope::slam {

/// An oriented corner of one picture.
struct Keypoint {
  float x = 0, y = 0;    // [px] in the captured (distorted) picture at full resolution, sub-pixel
  float ux = 0, uy = 0;  // [px] undistorted: K * (x/z, y/z, 1)
  float sigma = 1;       // [px] standard deviation assumed for (ux, uy): that of its pyramid level
                    //      (ExtractorSettings::keypoint_sigma_px) times the scale of the level and
                    //      the local magnification of undistortion
  float angle = 0;     // [rad] from +x towards +y, (-pi, pi], by the intensity centroid
  float response = 0;  // FAST score [grey levels]
  std::uint8_t octave = 0;
};

}  // namespace depthscope::slam
