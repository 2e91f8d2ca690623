#include "slam/pose_optimizer.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace depthscope::slam {
namespace {

constexpr double kConvergedStep = 1e-10;  // norm of (w [rad], v relative to the scene's depth)

struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();  // minus the gradient
  double cost = 0;                // robust, [sigma^2]
  double depth_sum = 0;
  int terms = 0;
};

/// Squared error in sigma; infinite behind the camera, so that the point is an outlier there.
double chi2(const Intrinsics& camera, const PoseObservation& o, const Pose& T_camera_world) {
  const Eigen::Vector3d p = T_camera_world * o.point_world;
  if (!(p.z() > kMinDepth)) return std::numeric_limits<double>::infinity();
  return (camera.project(p) - o.pixel).squaredNorm() * o.inv_sigma2;
}

NormalEquations accumulate(const Intrinsics& camera, std::span<const PoseObservation> observations,
                           const Pose& T_camera_world, double huber_delta) {
  NormalEquations n;
  for (const PoseObservation& o : observations) {
    if (!o.inlier) continue;
    const Eigen::Vector3d p = T_camera_world * o.point_world;
    if (!(p.z() > kMinDepth)) continue;
    const Eigen::Vector2d r = camera.project(p) - o.pixel;
    const double e2 = r.squaredNorm() * o.inv_sigma2;
    if (!std::isfinite(e2)) continue;
    const double w = o.weight * o.inv_sigma2 * huberWeight(e2, huber_delta);
    const Eigen::Matrix<double, 2, 6> J = poseJacobian(camera, p);
    n.H.noalias() += J.transpose() * (w * J);
    n.b.noalias() -= J.transpose() * (w * r);
    n.cost += o.weight * huberCost(e2, huber_delta);
    n.depth_sum += p.z();
    ++n.terms;
  }
  return n;
}

/// Gauss-Newton until the step is negligible or the cost no longer falls. False when the system is
/// singular at the start.
bool descend(const Intrinsics& camera, std::span<const PoseObservation> observations,
             double huber_delta, const PoseOptimizerSettings& settings, Pose& T_camera_world) {
  NormalEquations n = accumulate(camera, observations, T_camera_world, huber_delta);
  for (int i = 0; i < settings.iterations; ++i) {
    if (n.terms < settings.min_observations) return false;
    const Eigen::LDLT<Matrix6d> ldlt(n.H);
    const Vector6d step = ldlt.solve(n.b);
    if (ldlt.info() != Eigen::Success || !ldlt.isPositive() || !step.allFinite()) return i > 0;
    const Pose candidate = T_camera_world.retract(step.head<3>(), step.tail<3>());
    const NormalEquations next = accumulate(camera, observations, candidate, huber_delta);
    if (next.terms < n.terms || !(next.cost <= n.cost)) break;
    T_camera_world = candidate;
    const double depth = n.depth_sum / n.terms;
    n = next;
    if (step.head<3>().norm() + step.tail<3>().norm() / depth < kConvergedStep) break;
  }
  return true;
}

/// Sets every verdict; returns how many changed.
int classify(const Intrinsics& camera, std::span<PoseObservation> observations,
             const Pose& T_camera_world, double chi2_inlier, int& inliers) {
  int changed = 0;
  inliers = 0;
  for (PoseObservation& o : observations) {
    const bool inlier = chi2(camera, o, T_camera_world) <= chi2_inlier;
    changed += inlier != o.inlier;
    o.inlier = inlier;
    inliers += inlier;
  }
  return changed;
}

double rms(const Intrinsics& camera, std::span<const PoseObservation> observations,
           const Pose& T_camera_world, int inliers) {
  double sum = 0;
  for (const PoseObservation& o : observations)
    if (o.inlier) sum += chi2(camera, o, T_camera_world);
  return std::sqrt(sum / inliers);
}

}  // namespace

PoseOptimizerResult optimizePose(const Intrinsics& camera, std::span<PoseObservation> observations,
                                 Pose& T_camera_world, const PoseOptimizerSettings& settings) {
  PoseOptimizerResult result;
  Pose pose = T_camera_world;
  for (int round = 0; round < settings.rounds; ++round) {
    const bool robust = round < settings.rounds / 2;
    const double delta =
        robust ? std::sqrt(settings.chi2_inlier) : std::numeric_limits<double>::infinity();
    if (!descend(camera, observations, delta, settings, pose)) return result;
    const int changed = classify(camera, observations, pose, settings.chi2_inlier, result.inliers);
    if (result.inliers < settings.min_observations) return result;
    if (!robust && changed == 0) break;
  }

  const NormalEquations n =
      accumulate(camera, observations, pose, std::numeric_limits<double>::infinity());
  const Eigen::LDLT<Matrix6d> ldlt(n.H);
  result.covariance = ldlt.solve(Matrix6d::Identity());
  if (ldlt.info() != Eigen::Success || !ldlt.isPositive() || !result.covariance.allFinite())
    return result;
  result.rms_px = rms(camera, observations, pose, result.inliers);
  result.ok = true;
  T_camera_world = pose;
  return result;
}

}  // namespace depthscope::slam
