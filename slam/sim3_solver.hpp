#pragma once
#include <array>
#include <span>

#include "slam/intrinsics.hpp"
#include "slam/sim3.hpp"

namespace depthscope::slam {

/// The same piece of tissue as two maps have it (or as the two ends of a loop have it), each with a
/// keyframe that sees it.
struct Sim3Match {
  Eigen::Vector3d point_old, point_new;  // in the worlds of the old and of the new map
  Pose T_view_old, T_view_new;           // camera from world, of the keyframes that see them
  Eigen::Vector2d pixel_old, pixel_new;  // undistorted [px], in these keyframes
  double inv_sigma2_old = 1, inv_sigma2_new = 1;  // [1/px^2]
  bool inlier = true;                             // out: verdict
};

struct Sim3Settings {
  int ransac_iterations = 400;
  int min_inliers = 15;
  double chi2_inlier = 9.210;  // 99 % quantile for 2 degrees of freedom, in each of the two views
  int rounds = 3, iterations = 8;  // of the refinement
};

/// The similarity that takes three or more points onto others with least squared error, its scale
/// by the ratio of their spreads (Horn 1987). False when either set is collinear.
bool alignPoints(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to,
                 Sim3& T_to_from);

/// Squared whitened reprojection errors of a match, in the view of the old map and in that of the
/// new; infinite behind the camera.
std::array<double, 2> sim3Errors(const Intrinsics& camera, const Sim3Match& match,
                                 const Sim3& T_old_new, const Sim3& T_new_old);

/// Similarity between two maps from matches of which many may be wrong: Horn's closed form in
/// RANSAC, matches judged by reprojection both ways (Mur-Artal et al. 2015, section VII.B), then
/// refineSim3(). Deterministic. Sets the verdicts; returns the number of inliers, 0 when fewer than
/// min_inliers agree.
int solveSim3(const Intrinsics& camera, std::span<Sim3Match> matches, const Sim3Settings& settings,
              Sim3& T_old_new);

/// Gauss-Newton on the reprojection errors both ways under Huber's cost, from `T_old_new`; between
/// rounds all matches are judged afresh. Sets the verdicts; returns the number of inliers, 0 when
/// it fails.
int refineSim3(const Intrinsics& camera, std::span<Sim3Match> matches, const Sim3Settings& settings,
               Sim3& T_old_new);

/// d (residuals in the old and the new view) / d (tangent x), where T_old_new becomes
/// exp(x) T_old_new; also the residuals [px]. For refineSim3(), and its test.
void linearizeSim3(const Intrinsics& camera, const Sim3Match& match, const Sim3& T_old_new,
                   Eigen::Matrix<double, 4, 1>& residual, Eigen::Matrix<double, 4, 7>& J);

}  // namespace depthscope::slam
