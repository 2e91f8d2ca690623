#pragma once
#include <Eigen/Core>

#include "types/pose.hpp"

namespace depthscope::slam {

/// Point of the world seen at normalized image coordinates (x/z, y/z) `point_a` in camera a and
/// `point_b` in camera b: rayMidpoint, then Gauss-Newton on the reprojection errors of both views,
/// which is the maximum likelihood estimate for equal noise (Hartley & Zisserman,
/// section 12.3). False, with `world` untouched, when the rays are parallel or the point is not in
/// front of both.
bool triangulate(const Pose& T_a_world, const Eigen::Vector2d& point_a, const Pose& T_b_world,
                 const Eigen::Vector2d& point_b, Eigen::Vector3d& world);

/// Midpoint of the shortest line between the two rays, in camera a's frame: `triangulate` before it
/// is improved. False, with `point` untouched, when the rays are parallel.
bool rayMidpoint(const Eigen::Vector2d& point_a, const Pose& T_b_a, const Eigen::Vector2d& point_b,
                 Eigen::Vector3d& point);

/// Cosine of the angle at `world` between the rays to the two camera centres (world frame): 1 when
/// there is no parallax.
double parallaxCosine(const Eigen::Vector3d& world, const Eigen::Vector3d& centre_a,
                      const Eigen::Vector3d& centre_b);

/// Cosine of the angle between two viewing rays, before there is a point: inputs as in
/// `triangulate`.
double rayParallaxCosine(const Pose& T_a_world, const Eigen::Vector2d& point_a,
                         const Pose& T_b_world, const Eigen::Vector2d& point_b);

}  // namespace depthscope::slam
