// What a bundle adjustment says of a parameter that all its observations share.
#include <algorithm>
#include <cmath>

#include "slam/bundle_adjuster.hpp"

namespace depthscope::slam {
namespace {

// Relative damping: nothing but what makes the system regular, for the scale of a map is free.
constexpr double kLambda = 1e-10;

}  // namespace

std::optional<BaShared> BundleAdjuster::estimateShared(const Intrinsics& camera,
                                                       const BaSettings& settings) {
  indexProblem();
  const double huber_delta = std::sqrt(settings.chi2_inlier);
  linearize(camera, huber_delta);
  if (!computeStep(kLambda)) return std::nullopt;
  std::fill_n(border_.begin(), free_poses_, Vector6d::Zero());
  border_H_ = border_b_ = 0;
  for (int p = 0; p < static_cast<int>(points_.size()); ++p) borderPoint(camera, huber_delta, p);
  std::copy_n(border_.begin(), free_poses_, border_solved_.begin());
  reduced_.solve({border_solved_.data(), static_cast<std::size_t>(free_poses_)});
  double H = border_H_, b = border_b_;
  for (int i = 0; i < free_poses_; ++i) {
    H -= border_[i].dot(border_solved_[i]);
    b -= border_[i].dot(pose_step_[i]);
  }
  if (!(H > 0) || !std::isfinite(b)) return std::nullopt;
  return BaShared{b / H, 1 / std::sqrt(H)};
}

/// What the observations of a point say of the shared parameter, the point being free.
void BundleAdjuster::borderPoint(const Intrinsics& camera, double huber_delta, int point) {
  Eigen::Vector3d coupling = Eigen::Vector3d::Zero();  // with the point
  for (int t = first_term_[point]; t < first_term_[point + 1]; ++t) {
    const Term& term = terms_[t];
    const Pose& T_camera_world = poses_[term.pose].T_camera_world;
    const Eigen::Vector3d p = T_camera_world * points_[point];
    if (!(p.z() > kMinDepth)) continue;
    const Eigen::Vector2d r = camera.project(p) - term.pixel;
    const Eigen::Vector2d s = term.shift.cast<double>();
    const double weight =
        term.inv_sigma2 * huberWeight(r.squaredNorm() * term.inv_sigma2, huber_delta);
    coupling +=
        weight * pointJacobian(projectionJacobian(camera, p), T_camera_world.R).transpose() * s;
    border_H_ += weight * s.squaredNorm();
    border_b_ -= weight * s.dot(r);
    if (term.block >= 0) border_[term.block] += weight * poseJacobian(camera, p).transpose() * s;
  }
  const PointBlock& block = point_blocks_[point];
  const Eigen::Vector3d whitened = block.L_inv * coupling;
  border_H_ -= whitened.squaredNorm();
  border_b_ -= whitened.dot(block.L_inv * block.b);
  const Eigen::Vector3d pull = block.L_inv.transpose() * whitened;
  for (int t = first_term_[point]; t < first_term_[point + 1]; ++t)
    if (terms_[t].block >= 0) border_[terms_[t].block].noalias() -= W_[t] * pull;
}

}  // namespace depthscope::slam
