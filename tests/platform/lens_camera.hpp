#pragma once
#include "types/camera_model.hpp"

namespace depthscope::platform {

/// 640x480 with a little barrel distortion.
inline CameraModel lensCamera() {
  CameraModel c;
  c.width = 640;
  c.height = 480;
  c.fx = c.fy = 500;
  c.cx = 320;
  c.cy = 240;
  c.k = {-0.1, 0.01, 0.001, -0.001, 0};
  return c;
}

}  // namespace depthscope::platform
