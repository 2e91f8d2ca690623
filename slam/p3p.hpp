#pragma once
#include <Eigen/Core>
#include <array>

#include "types/pose.hpp"

namespace depthscope::slam {

/// The poses T_camera_world, up to four, that see three world points along three unit bearings
/// (camera frame), by the conic pencil of Persson & Nordberg 2018, "Lambda Twist". Returns how
/// many.
int solveP3p(const std::array<Eigen::Vector3d, 3>& bearings,
             const std::array<Eigen::Vector3d, 3>& points_world, std::array<Pose, 4>& poses);

}  // namespace depthscope::slam
