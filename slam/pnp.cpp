#include "slam/pnp.hpp"

#include <algorithm>
#include <cmath>

#include "slam/p3p.hpp"
#include "slam/random_sample.hpp"

namespace depthscope::slam {
namespace {

constexpr int kSampleSize = 3;

/// Samples after which one free of outliers has been drawn with the given confidence.
int iterationsNeeded(double inlier_share, double confidence, int at_most) {
  const double clean = std::pow(inlier_share, kSampleSize);
  if (clean >= 1) return 1;
  const double needed = std::log(1 - confidence) / std::log1p(-clean);
  return needed < at_most ? static_cast<int>(std::ceil(needed)) : at_most;
}

}  // namespace

PnpSolver::PnpSolver(const PnpSettings& settings, int max_matches) : settings_(settings) {
  bearings_.resize(max_matches);
}

bool PnpSolver::solve(const Intrinsics& camera, std::span<PoseObservation> observations,
                      PnpResult& result) {
  for (PoseObservation& o : observations) o.inlier = false;
  const auto used = observations.first(std::min(observations.size(), bearings_.size()));
  const int n = static_cast<int>(used.size());
  if (n < std::max(settings_.min_inliers, kSampleSize)) return false;
  for (int i = 0; i < n; ++i)
    bearings_[i] = camera.normalize(used[i].pixel).homogeneous().normalized();

  std::mt19937 generator(n);
  Score best;
  Pose best_pose;
  int iterations = settings_.ransac_iterations;
  for (int i = 0; i < iterations; ++i) {
    const auto [a, b, c] = drawSample<kSampleSize>(generator, n);
    std::array<Pose, 4> poses;
    const int count =
        solveP3p({bearings_[a], bearings_[b], bearings_[c]},
                 {used[a].point_world, used[b].point_world, used[c].point_world}, poses);
    for (int k = 0; k < count; ++k) {
      const Score s = score(camera, used, poses[k], best.value);
      if (s.value <= best.value) continue;
      best = s;
      best_pose = poses[k];
      iterations =
          std::min(iterations, iterationsNeeded(static_cast<double>(s.inliers) / n,
                                                settings_.confidence, settings_.ransac_iterations));
    }
  }
  if (best.inliers < settings_.min_inliers) return false;

  for (PoseObservation& o : used) {
    const Eigen::Vector3d p = best_pose * o.point_world;
    o.inlier = p.z() > kMinDepth &&
               (camera.project(p) - o.pixel).squaredNorm() * o.inv_sigma2 <= settings_.chi2_inlier;
  }
  PoseOptimizerSettings refinement;
  refinement.chi2_inlier = settings_.chi2_inlier;
  const PoseOptimizerResult refined = optimizePose(camera, used, best_pose, refinement);
  if (!refined.ok || refined.inliers < settings_.min_inliers) {
    for (PoseObservation& o : observations) o.inlier = false;
    return false;
  }
  result = {best_pose, refined.inliers, refined.rms_px};
  return true;
}

/// Sum over the matches of what is left between error and threshold; given up, with a value that
/// does not beat `to_beat`, as soon as the matches to come cannot make up for those behind.
PnpSolver::Score PnpSolver::score(const Intrinsics& camera,
                                  std::span<const PoseObservation> observations,
                                  const Pose& T_camera_world, double to_beat) const {
  Score s;
  double possible = settings_.chi2_inlier * static_cast<double>(observations.size());
  for (const PoseObservation& o : observations) {
    const Eigen::Vector3d p = T_camera_world * o.point_world;
    double left = 0;
    if (p.z() > kMinDepth) {
      const double chi2 = (camera.project(p) - o.pixel).squaredNorm() * o.inv_sigma2;
      left = std::max(0.0, settings_.chi2_inlier - chi2);
    }
    s.value += left;
    s.inliers += left > 0;
    possible -= settings_.chi2_inlier - left;
    if (possible <= to_beat) return {};
  }
  return s;
}

}  // namespace depthscope::slam
