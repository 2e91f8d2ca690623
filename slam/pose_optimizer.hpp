#pragma once
#include <Eigen/Core>
#include <span>

#include "slam/projection.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

/// One map point seen in the frame whose pose is sought.
struct PoseObservation {
  Eigen::Vector3d point_world = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // undistorted [px]
  double inv_sigma2 = 1;  // [1/px^2], of the pyramid level it was found in
  double weight = 1;      // relative: less for points that are trusted less
  bool inlier = true;     // in: take part in the first round; out: verdict
};

struct PoseOptimizerSettings {
  int rounds = 4;       // between rounds all observations are classified afresh
  int iterations = 10;  // per round, at most
  double chi2_inlier = kChi2TwoDof95;
  int min_observations = 6;  // fewer cannot be trusted to hold six unknowns
};

struct PoseOptimizerResult {
  bool ok = false;  // false: too few inliers or a singular system, the pose is as it was
  int inliers = 0;
  double rms_px = 0;  // of the inliers, whitened: pixels at the level a point was found in
  Matrix6d covariance = Matrix6d::Zero();  // of (w, v) in Pose::retract; [rad], [map units]
};

/// Refines T_camera_world by motion-only bundle adjustment: Gauss-Newton on the reprojection errors
/// under Huber's cost, the points held fixed; outliers are taken out, and may come back, between
/// the rounds; the last two rounds do without the robust cost (Mur-Artal et al. 2015, section V).
PoseOptimizerResult optimizePose(const Intrinsics& camera, std::span<PoseObservation> observations,
                                 Pose& T_camera_world, const PoseOptimizerSettings& settings = {});

}  // namespace depthscope::slam
