#pragma once
#include <Eigen/Core>

#include "types/pose.hpp"

namespace depthscope::slam {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// A similarity: p_a = s R p_b + t for `T_a_b`. What is left undetermined between two maps of one
/// camera, and between the ends of a loop (Strasdat et al. 2010). Tangent vectors are (w, v,
/// sigma): rotation [rad], translation, logarithm of the scale.
struct Sim3 {
  double s = 1;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Sim3() = default;
  Sim3(double scale, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation)
      : s(scale), R(rotation), t(translation) {}
  explicit Sim3(const Pose& pose) : R(pose.R), t(pose.t) {}

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return s * (R * p) + t; }
  Sim3 operator*(const Sim3& b) const { return {s * b.s, R * b.R, s * (R * b.t) + t}; }
  Sim3 inverse() const {
    Sim3 T;
    T.s = 1 / s;
    T.R = R.transpose();
    T.t = -T.s * (T.R * t);
    return T;
  }
  bool allFinite() const { return std::isfinite(s) && R.allFinite() && t.allFinite(); }

  /// The camera whose world was moved by this similarity `T_new_old`: T_camera_old in the new
  /// world, its own unit of length the new one. R is kept orthonormal, however often.
  Pose moved(const Pose& T_camera_old) const {
    const Sim3 camera = Sim3(T_camera_old) * inverse();
    return {orthonormal(camera.R), camera.t / camera.s};
  }
  /// As a rigid transform of which this is the multiple: R, t / s.
  Pose normalized() const { return {R, t / s}; }
};

/// The group's exponential map and its inverse.
Sim3 expSim3(const Vector7d& tangent);
Vector7d logSim3(const Sim3& T);
/// exp(Ad_T x) = T exp(x) T^-1.
Matrix7d adjoint(const Sim3& T);
/// Inverse of the left Jacobian: log(exp(dx) exp(x)) = x + J dx + O(dx^2). From the series of
/// Baker, Campbell and Hausdorff; good to 1e-6 for |x| below 0.7.
Matrix7d leftJacobianInverse(const Vector7d& x);

}  // namespace depthscope::slam
