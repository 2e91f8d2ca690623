#pragma once
#include <Eigen/Core>
#include <array>

#include "types/pose.hpp"

namespace depthscope::slam {

/// The essential matrices, up to ten, with x2^T E x1 = 0 for five pairs of normalized image
/// coordinates, by the real roots of a polynomial of degree ten (Nister 2004: An efficient solution
/// to the five-point relative pose problem, section 3). Unlike the eight-point algorithm it holds
/// for planar scenes too. Each has Frobenius norm sqrt(2). Returns how many.
int solveEssentialFivePoint(const std::array<Eigen::Vector2d, 5>& first,
                            const std::array<Eigen::Vector2d, 5>& second,
                            std::array<Eigen::Matrix3d, 10>& E);

/// The four motions T_second_first, |t| = 1, that an essential matrix allows (Hartley & Zisserman,
/// result 9.19).
void decomposeEssential(const Eigen::Matrix3d& E, std::array<Pose, 4>& T_second_first);

}  // namespace depthscope::slam
