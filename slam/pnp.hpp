#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "slam/pose_optimizer.hpp"
#include "slam/projection.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

struct PnpSettings {
  int ransac_iterations = 300;  // at most; fewer once `confidence` is reached
  double confidence = 0.999;    // of having drawn one sample without an outlier
  int min_inliers = 15;
  double chi2_inlier = kChi2TwoDof95;
};

struct PnpResult {
  Pose T_camera_world;
  int inliers = 0;
  double rms_px = 0;  // of the inliers
};

/// Camera pose from matches of map points to pixels among which many may be wrong: minimal solver
/// for three points in RANSAC, then motion-only bundle adjustment. Deterministic: the samples
/// depend on the number of matches alone. All storage is allocated by the constructor.
class PnpSolver {
 public:
  PnpSolver(const PnpSettings& settings, int max_matches);

  /// Sets `inlier` of every observation (its value before is not looked at) and fills `result`.
  /// False when fewer than min_inliers agree. Matches beyond max_matches are ignored, as outliers.
  bool solve(const Intrinsics& camera, std::span<PoseObservation> observations, PnpResult& result);

 private:
  struct Score {
    double value = 0;
    int inliers = 0;
  };
  Score score(const Intrinsics& camera, std::span<const PoseObservation> observations,
              const Pose& T_camera_world, double to_beat) const;

  PnpSettings settings_;
  std::vector<Eigen::Vector3d> bearings_;  // unit, camera frame
};

}  // namespace depthscope::slam
