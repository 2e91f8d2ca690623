#pragma once
#include "types/camera_model.hpp"

namespace depthscope::overlay {

/// Largest undistorted radius |(x/z, y/z)| up to which the lens keeps the order of points: beyond
/// it the distortion polynomial folds back (or nearly), and a point far outside the view would land
/// inside it. Tangential terms are left out: they are small wherever the model means anything. At
/// most tan(85 deg).
double validRadius(const CameraModel& camera);

}  // namespace depthscope::overlay
