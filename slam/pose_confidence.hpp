#pragma once
#include <algorithm>
#include <array>

#include "slam/pose_tracker.hpp"

namespace depthscope::slam {

/// How far the points recognised in a frame spread, 0..1. Inliers that crowd into a corner say
/// little about the rest of the picture, so the cells of a 4 x 4 grid that hold some are counted,
/// of those that hold features at all.
inline float inlierSpread(const TrackedFrame& frame, const CameraModel& camera) {
  constexpr int kCells = 4, kMinFeatures = 5, kMinInliers = 2;
  std::array<int, kCells * kCells> features{}, found{};
  for (int f = 0; f < frame.features.size(); ++f) {
    const Keypoint& k = frame.features.keypoints[f];
    const int row = std::clamp(static_cast<int>(k.y * kCells / static_cast<float>(camera.height)),
                               0, kCells - 1);
    const int column = std::clamp(static_cast<int>(k.x * kCells / static_cast<float>(camera.width)),
                                  0, kCells - 1);
    ++features[row * kCells + column];
    found[row * kCells + column] += frame.points[f].id != kNone;
  }
  int textured = 0, covered = 0;
  for (int c = 0; c < kCells * kCells; ++c) {
    textured += features[c] >= kMinFeatures;
    covered += features[c] >= kMinFeatures && found[c] >= kMinInliers;
  }
  return textured == 0 ? 0.f : static_cast<float>(covered) / static_cast<float>(textured);
}

/// How far off [px] what is drawn on the scene may lie: standard deviation, root mean square over
/// the picture, of where points at `depth` appear under the pose's covariance; 0 where no depth is
/// known.
inline double pictureSigma_px(const Matrix6d& covariance, double depth, const CameraModel& camera) {
  if (!(depth > 0)) return 0;
  const Intrinsics intrinsics{camera.fx, camera.fy, camera.cx, camera.cy};
  constexpr int kGrid = 3;
  double variance = 0;
  for (int row = 0; row < kGrid; ++row)
    for (int column = 0; column < kGrid; ++column) {
      const Eigen::Vector2d px((column + 0.5) * camera.width / kGrid,
                               (row + 0.5) * camera.height / kGrid);
      const Eigen::Vector3d p = depth * intrinsics.normalize(px).homogeneous();
      const Eigen::Matrix<double, 2, 6> J = poseJacobian(intrinsics, p);
      variance += (J * covariance * J.transpose()).trace();
    }
  return std::sqrt(variance / (kGrid * kGrid));
}

/// Trust in the pose of a tracked frame, 0..1: whether there are inliers enough, times their
/// spread, less where an overlay may lie more than a pixel off.
inline float poseConfidence(const TrackedFrame& frame, int inliers, int comfortable_inliers,
                            const CameraModel& camera) {
  constexpr double kGoodSigma_px = 1;
  const double sigma_px = pictureSigma_px(frame.covariance, frame.depth, camera);
  return inlierSpread(frame, camera) *
         std::min(1.f, static_cast<float>(inliers) / static_cast<float>(comfortable_inliers)) *
         static_cast<float>(std::min(1.0, kGoodSigma_px / std::max(sigma_px, 1e-6)));
}

}  // namespace depthscope::slam
