#include "slam/triangulation.hpp"

#include <Eigen/LU>
#include <cmath>

#include "slam/projection.hpp"

namespace depthscope::slam {
namespace {

constexpr double kParallelSin2 =
    1e-14;  // squared sine of the angle between two rays called parallel
constexpr int kRefinements = 3;
constexpr double kConvergedStep2 = 1e-12;  // squared, of the step relative to the distance

/// One Gauss-Newton step on the errors in normalized coordinates of both views, p in camera a's
/// frame. `converged`: another would change nothing that counts.
bool refine(const Eigen::Vector2d& point_a, const Pose& T_b_a, const Eigen::Vector2d& point_b,
            Eigen::Vector3d& p, bool& converged) {
  const Intrinsics unit;
  const Eigen::Vector3d q = T_b_a * p;
  if (p.z() < kMinDepth || q.z() < kMinDepth) return false;
  const Eigen::Matrix<double, 2, 3> Ja = projectionJacobian(unit, p);
  const Eigen::Matrix<double, 2, 3> Jb = pointJacobian(projectionJacobian(unit, q), T_b_a.R);
  const Eigen::Matrix3d H = Ja.transpose() * Ja + Jb.transpose() * Jb;
  const Eigen::Vector3d g =
      Ja.transpose() * (unit.project(p) - point_a) + Jb.transpose() * (unit.project(q) - point_b);
  Eigen::Matrix3d H_inv;
  bool invertible = false;
  H.computeInverseWithCheck(H_inv, invertible, 0);
  if (!invertible) return false;
  const Eigen::Vector3d step = H_inv * g;
  p -= step;
  converged = step.squaredNorm() < kConvergedStep2 * p.squaredNorm();
  return p.allFinite();
}

}  // namespace

bool rayMidpoint(const Eigen::Vector2d& point_a, const Pose& T_b_a, const Eigen::Vector2d& point_b,
                 Eigen::Vector3d& point) {
  const Eigen::Vector3d ray_a = point_a.homogeneous().normalized();
  const Eigen::Vector3d ray_b = T_b_a.R.transpose() * point_b.homogeneous().normalized();
  const Eigen::Vector3d centre_b = -(T_b_a.R.transpose() * T_b_a.t);

  // Between the rays s ray_a and centre_b + u ray_b.
  const double c = ray_a.dot(ray_b);
  const double sin2 = ray_a.cross(ray_b).squaredNorm();
  if (!(sin2 > kParallelSin2)) return false;
  const double along_a = ray_a.dot(centre_b), along_b = ray_b.dot(centre_b);
  const double s = (along_a - c * along_b) / sin2;
  const double u = (c * along_a - along_b) / sin2;
  point = 0.5 * (s * ray_a + centre_b + u * ray_b);
  return true;
}

bool triangulate(const Pose& T_a_world, const Eigen::Vector2d& point_a, const Pose& T_b_world,
                 const Eigen::Vector2d& point_b, Eigen::Vector3d& world) {
  const Pose T_b_a = T_b_world * T_a_world.inverse();
  Eigen::Vector3d p;
  if (!rayMidpoint(point_a, T_b_a, point_b, p)) return false;
  bool converged = false;
  for (int i = 0; i < kRefinements && !converged; ++i)
    if (!refine(point_a, T_b_a, point_b, p, converged)) return false;
  if (p.z() < kMinDepth || (T_b_a * p).z() < kMinDepth) return false;
  world = T_a_world.inverse() * p;
  return true;
}

double parallaxCosine(const Eigen::Vector3d& world, const Eigen::Vector3d& centre_a,
                      const Eigen::Vector3d& centre_b) {
  return (world - centre_a).normalized().dot((world - centre_b).normalized());
}

double rayParallaxCosine(const Pose& T_a_world, const Eigen::Vector2d& point_a,
                         const Pose& T_b_world, const Eigen::Vector2d& point_b) {
  const Eigen::Vector3d ray_a = T_a_world.R.transpose() * point_a.homogeneous();
  const Eigen::Vector3d ray_b = T_b_world.R.transpose() * point_b.homogeneous();
  return ray_a.normalized().dot(ray_b.normalized());
}

}  // namespace depthscope::slam
