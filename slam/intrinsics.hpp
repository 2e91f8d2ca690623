#pragma once
#include <Eigen/Core>

namespace depthscope::slam {

/// Pinhole intrinsics of undistorted pixels [px]: everything in this folder that is called geometry
/// works on measurements from which the lens distortion has been taken out.
struct Intrinsics {
  double fx = 1, fy = 1, cx = 0, cy = 0;

  /// Point in the camera frame (z > 0) -> undistorted pixel.
  Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const {
    return {fx * p_camera.x() / p_camera.z() + cx, fy * p_camera.y() / p_camera.z() + cy};
  }
  /// Undistorted pixel -> normalized image coordinates (x/z, y/z).
  Eigen::Vector2d normalize(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy};
  }
};

}  // namespace depthscope::slam
