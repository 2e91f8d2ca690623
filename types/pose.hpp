#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace depthscope {

/// 3x3 matrix [v]x with [v]x w = v x w.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation of |w| radians about w (Rodrigues).
inline Eigen::Matrix3d expSO3(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity() + skew(w);
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// Rotation vector of R [rad], |w| <= pi.
inline Eigen::Vector3d logSO3(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd a(R);
  return a.angle() * a.axis();
}

/// The rotation next to a product of rotations: what rounding did to it grows with every product,
/// and threefold with every R R^T R.
inline Eigen::Matrix3d orthonormal(const Eigen::Matrix3d& R) {
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

/// A rigid transform. `T_a_b` takes a point of frame b into frame a: p_a = T_a_b * p_b; chains read
/// off: T_a_c = T_a_b * T_b_c. Camera frames: x right, y down, z forward. Length unit: the map's.
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
  Pose operator*(const Pose& b) const { return {R * b.R, R * b.t + t}; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * t)}; }

  /// Left update by a small motion (rotation w [rad], translation v): {exp(w), v} * (*this), R kept
  /// orthonormal.
  Pose retract(const Eigen::Vector3d& w, const Eigen::Vector3d& v) const {
    const Eigen::Matrix3d dR = expSO3(w);
    return {orthonormal(dR * R), dR * t + v};
  }
  Eigen::Quaterniond quaternion() const { return Eigen::Quaterniond(R).normalized(); }
  bool allFinite() const { return R.allFinite() && t.allFinite(); }
};

/// How far apart two views of a scene are: distance of the cameras over its depth, plus the angle
/// between their optical axes [rad]; roughly the share of the focal length that the picture moves
/// by.
inline double motionBetween(const Pose& T_a_world, const Pose& T_b_world, double depth) {
  const double cosine = T_a_world.R.row(2).dot(T_b_world.R.row(2));
  const double apart = (T_a_world.inverse().t - T_b_world.inverse().t).norm();
  return apart / depth + std::acos(cosine < -1 ? -1 : cosine > 1 ? 1 : cosine);
}

}  // namespace depthscope
