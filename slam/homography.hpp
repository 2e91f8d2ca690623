#pragma once
#include <Eigen/Core>
#include <array>
#include <span>

#include "types/pose.hpp"

namespace depthscope::slam {

/// Homography x2 ~ H x1 from four pairs of normalized image coordinates, in closed form, or from
/// more of them by the normalized direct linear transform (Hartley & Zisserman, algorithm 4.2).
/// Frobenius norm one. False when they are degenerate.
bool fitHomography(std::span<const Eigen::Vector2d> first, std::span<const Eigen::Vector2d> second,
                   Eigen::Matrix3d& H_second_first);

/// The eight motions and planes that explain a homography between normalized image coordinates
/// (Faugeras & Lustman 1988, section 3): T_second_first with |t| = 1. Returns how many: 0 when H is
/// close to a pure rotation, whose singular values are equal and which tells nothing of t.
int decomposeHomography(const Eigen::Matrix3d& H_second_first, std::array<Pose, 8>& T_second_first);

}  // namespace depthscope::slam
