#pragma once
#include <Eigen/Core>
#include <cmath>

#include "slam/intrinsics.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// 95 % quantile of chi squared with 2 degrees of freedom: a reprojection error above it is an
/// outlier.
inline constexpr double kChi2TwoDof95 = 5.991;
/// The same with 1 degree of freedom: for the distance to an epipolar line.
inline constexpr double kChi2OneDof95 = 3.841;
/// A point nearer to the camera plane than this [map units] has no usable projection.
inline constexpr double kMinDepth = 1e-9;

/// d pixel / d p_camera, 2x3 [px / map unit].
inline Eigen::Matrix<double, 2, 3> projectionJacobian(const Intrinsics& camera,
                                                      const Eigen::Vector3d& p_camera) {
  const double z_inv = 1 / p_camera.z();
  const double x = p_camera.x() * z_inv, y = p_camera.y() * z_inv;
  Eigen::Matrix<double, 2, 3> J;
  J << camera.fx * z_inv, 0, -camera.fx * x * z_inv, 0, camera.fy * z_inv, -camera.fy * y * z_inv;
  return J;
}

/// d pixel / d (w, v), 2x6, where the pose T_camera_world is updated by `Pose::retract(w, v)`:
/// p_camera becomes exp(w) p_camera + v. Columns: rotation [px / rad], translation [px / map unit].
inline Eigen::Matrix<double, 2, 6> poseJacobian(const Intrinsics& camera,
                                                const Eigen::Vector3d& p_camera) {
  const double z_inv = 1 / p_camera.z();
  const double x = p_camera.x() * z_inv, y = p_camera.y() * z_inv;
  Eigen::Matrix<double, 2, 6> J;
  J << -camera.fx * x * y, camera.fx * (1 + x * x), -camera.fx * y,  //
      camera.fx * z_inv, 0, -camera.fx * x * z_inv,                  //
      -camera.fy * (1 + y * y), camera.fy * x * y, camera.fy * x,    //
      0, camera.fy * z_inv, -camera.fy * y * z_inv;
  return J;
}

/// d pixel / d p_world, 2x3, from the projection Jacobian at p_camera and the rotation of
/// T_camera_world.
inline Eigen::Matrix<double, 2, 3> pointJacobian(const Eigen::Matrix<double, 2, 3>& J_projection,
                                                 const Eigen::Matrix3d& R_camera_world) {
  return J_projection * R_camera_world;
}

/// Huber's robust cost of a squared, whitened error `chi2` [sigma^2]: quadratic up to delta
/// [sigma], linear beyond.
inline double huberCost(double chi2, double delta) {
  return chi2 <= delta * delta ? chi2 : 2 * delta * std::sqrt(chi2) - delta * delta;
}

/// Weight that makes least squares minimise `huberCost`: its derivative by chi2, in (0, 1].
inline double huberWeight(double chi2, double delta) {
  return chi2 <= delta * delta ? 1 : delta / std::sqrt(chi2);
}

}  // namespace depthscope::slam
