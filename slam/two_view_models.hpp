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
  std::vector<Eigen::Vector2d> first_px, second_px;  // [px]
  std::vector<Eigen::Vector2d> first, second;        // normalized
};

/// A model of how the second view follows from the first, found by RANSAC.
struct TwoViewModel {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  // on normalized coordinates
  double score = 0;                                  // higher is better, comparable between models
  int inliers = 0;
};

/// Homography and essential matrix with the best scores among those fitted to the same random
/// samples, four and five matches each; the score sums, over matches and both directions, what the
/// squared transfer error [sigma^2] leaves of the threshold (Mur-Artal et al. 2015, section IV,
/// step 2).
void findTwoViewModels(const TwoViewMatches& matches, double sigma_px, int iterations,
                       TwoViewModel& homography, TwoViewModel& essential);

/// Number of matches that a rotation of the camera alone explains, the best that RANSAC finds.
int countRotationInliers(const TwoViewMatches& matches, double sigma_px, int iterations);

/// Marks, per match, whether it agrees with the model in both directions; returns how many.
int markHomographyInliers(const TwoViewMatches& matches, const Eigen::Matrix3d& H_second_first,
                          double sigma_px, std::span<std::uint8_t> inlier);
int markEssentialInliers(const TwoViewMatches& matches, const Eigen::Matrix3d& E, double sigma_px,
                         std::span<std::uint8_t> inlier);

}  // namespace depthscope::slam
