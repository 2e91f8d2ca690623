#include "slam/pose_optimizer.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "types/vector_clones.hpp"

namespace depthscope::slam {
namespace {

// Norm of (w [rad], v relative to the scene's depth); a thousandth of a pixel.
constexpr double kConvergedStep = 1e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

// Four observations side by side, each lane with sums of its own: the same bits on every processor.
constexpr int kLanes = 4;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
constexpr int kUpperTriangle = 21;
struct LaneSums {
  Lanes H[kUpperTriangle] = {};  // rows of the upper triangle, one behind the other
  Lanes b[6] = {};
  Lanes cost = {}, depth = {}, terms = {};
};

/// The next observations, one a lane; of weight zero where there is none or an outlier.
struct LaneObservations {
  Lanes x, y, z;  // in the world
  Lanes u, v;
  Lanes inv_sigma2, weight;

  void take(std::span<const PoseObservation> observations) {
    for (int l = 0; l < kLanes; ++l) {
      const bool used = l < static_cast<int>(observations.size()) && observations[l].inlier;
      const PoseObservation& o = observations[used ? l : 0];
      x[l] = o.point_world.x();
      y[l] = o.point_world.y();
      z[l] = o.point_world.z();
      u[l] = o.pixel.x();
      v[l] = o.pixel.y();
      inv_sigma2[l] = used ? o.inv_sigma2 : 0;
      weight[l] = used ? o.weight : 0;
    }
  }
};

DEPTHSCOPE_CLONES
void addLanes(const Intrinsics& camera, const Pose& T_camera_world, double huber_delta,
              const LaneObservations& o, LaneSums& sums) {
  const auto& R = T_camera_world.R;
  const auto& t = T_camera_world.t;
  const Lanes zero{}, one = zero + 1;
  const Lanes px = R(0, 0) * o.x + R(0, 1) * o.y + R(0, 2) * o.z + t(0);
  const Lanes py = R(1, 0) * o.x + R(1, 1) * o.y + R(1, 2) * o.z + t(1);
  const Lanes pz = R(2, 0) * o.x + R(2, 1) * o.y + R(2, 2) * o.z + t(2);
  const auto in_front = pz > kMinDepth;
  const Lanes z_inv = 1 / (in_front ? pz : one);
  const Lanes x = px * z_inv, y = py * z_inv;
  const Lanes ru = camera.fx * x + camera.cx - o.u, rv = camera.fy * y + camera.cy - o.v;
  const Lanes e2 = (ru * ru + rv * rv) * o.inv_sigma2;
  Lanes e;
  for (int l = 0; l < kLanes; ++l) e[l] = std::sqrt(e2[l]);
  const double delta2 = huber_delta * huber_delta;
  const Lanes huber_weight = e2 <= delta2 ? one : huber_delta / e;
  const Lanes huber_cost = e2 <= delta2 ? e2 : 2 * huber_delta * e - delta2;
  // Not what is behind the camera, nor what has no finite error.
  const auto used = in_front & (o.inv_sigma2 > 0) & (e2 < kInfinity);
  const Lanes w = used ? o.weight * o.inv_sigma2 * huber_weight : zero;
  sums.cost += used ? o.weight * huber_cost : zero;
  sums.depth += used ? pz : zero;
  sums.terms += used ? one : zero;

  // poseJacobian(), of u and of v, and what it is to explain.
  const Lanes jx = used ? x : zero, jy = used ? y : zero;
  const Lanes eu = used ? ru : zero, ev = used ? rv : zero;
  const double fx = camera.fx, fy = camera.fy;
  const Lanes ju[6] = {-fx * jx * jy, fx * (1 + jx * jx), -fx * jy, fx * z_inv,
                       zero,          -fx * jx * z_inv};
  const Lanes jv[6] = {-fy * (1 + jy * jy), fy * jx * jy,    fy * jx, zero,
                       fy * z_inv,          -fy * jy * z_inv};
  int k = 0;
  for (int r = 0; r < 6; ++r) {
    const Lanes wu = w * ju[r], wv = w * jv[r];
    sums.b[r] -= wu * eu + wv * ev;
    for (int c = r; c < 6; ++c) sums.H[k++] += wu * ju[c] + wv * jv[c];
  }
}

double sumOf(const Lanes& lanes) {
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

NormalEquations accumulate(const Intrinsics& camera, std::span<const PoseObservation> observations,
                           const Pose& T_camera_world, double huber_delta) {
  LaneSums sums;
  LaneObservations lanes;
  for (std::size_t i = 0; i < observations.size(); i += kLanes) {
    lanes.take(observations.subspan(i));
    addLanes(camera, T_camera_world, huber_delta, lanes, sums);
  }
  NormalEquations n;
  for (int r = 0, k = 0; r < 6; ++r) {
    n.b(r) = sumOf(sums.b[r]);
    for (int c = r; c < 6; ++c, ++k) n.H(r, c) = n.H(c, r) = sumOf(sums.H[k]);
  }
  n.cost = sumOf(sums.cost);
  n.depth_sum = sumOf(sums.depth);
  n.terms = static_cast<int>(sumOf(sums.terms));
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
