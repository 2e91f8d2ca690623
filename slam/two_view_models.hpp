#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/intrinsics.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

/// Matches between two views, as pixels and as normalized coordinates, in memory allocated once.
class TwoViewMatches {
 public:
  TwoViewMatches(const Intrinsics& camera, int max_matches);
  /// Undistorted pixels, pairwise; those beyond max_matches are left out.
  void load(std::span<const Eigen::Vector2f> first, std::span<const Eigen::Vector2f> second);

  int size() const { return static_cast<int>(first_px.size()); }
  const Intrinsics camera;
  std::vector<Eigen::Vector2d> first_px, second_px;         // [px]
  std::vector<float> first_x, first_y, second_x, second_y;  // [px] the same, for vectors of them
  std::vector<Eigen::Vector2d> first, second;               // normalized
};

/// A model of how the second view follows from the first, found by RANSAC.
struct TwoViewModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // on normalized coordinates
  double score = 0;                                  // higher is better, comparable between models
  int inliers = 0;
};

/// Number of matches that a rotation of the camera alone explains, the best that RANSAC finds.
int countRotationInliers(const TwoViewMatches& matches, double sigma_px, int iterations);

/// Fits a homography and an essential matrix to the same random samples, four and five matches
/// each. The score of a model sums, over matches and both directions, what the squared transfer
/// error [sigma^2] leaves of the threshold (Mur-Artal et al. 2015, section IV, step 2). At most
/// `iterations` samples are drawn, fewer where the essential matrix has so many inliers that they
/// held one free of outliers, but no fewer than 150.
class TwoViewModelFinder {
 public:
  explicit TwoViewModelFinder(int max_matches);
  void find(const TwoViewMatches& matches, double sigma_px, int iterations,
            TwoViewModel& homography, TwoViewModel& essential);

 private:
  void polishHomography(const TwoViewMatches& matches, double sigma_px, TwoViewModel& homography);

  std::vector<Eigen::Vector2d> inliers_first_, inliers_second_;  // scratch, normalized
};

}  // namespace depthscope::slam
