#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "types/camera_model.hpp"

namespace depthscope::slam {

/// Undistortion of pixels, fast: a table every few pixels, then one Newton step with the exact
/// model.
class UndistortionMap {
 public:
  explicit UndistortionMap(const CameraModel& camera);

  struct Point {
    Eigen::Vector2d pixel;  // K * (x/z, y/z, 1)
    double magnification;   // square root of the area that a captured pixel takes here
  };
  /// Captured pixel -> undistorted pixel, to within 0.01 px; nothing where the lens model is not
  /// one to one.
  std::optional<Point> operator()(const Eigen::Vector2d& captured) const;

 private:
  Eigen::Vector2d distortPixel(const Eigen::Vector2d& undistorted) const;

  CameraModel camera_;
  int columns_ = 0, rows_ = 0;          // nodes; none without distortion
  std::vector<Eigen::Vector2d> nodes_;  // undistorted pixel of each node
};

}  // namespace depthscope::slam
