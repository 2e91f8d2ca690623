#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "slam/intrinsics.hpp"
#include "slam/two_view_models.hpp"

namespace depthscope::slam {

/// Matches of a block: `count` of them, side by side.
struct MatchBlock {
  const float *first_x, *first_y, *second_x, *second_y;  // [px]
  int count;
};

/// Squared errors [px^2] of a block of matches, in either view; infinite beyond its end.
struct TransferErrors {
  static constexpr int block = 32;
  std::array<float, block> in_second, in_first;
};

/// The matches from `begin` on, as many as make a block or are left.
MatchBlock matchBlock(const TwoViewMatches& matches, int begin);

/// Symmetric transfer error of x2 ~ H x1 on pixels; H on normalized coordinates.
class HomographyErrors {
 public:
  HomographyErrors(const Intrinsics& camera, const Eigen::Matrix3d& H);
  void operator()(const MatchBlock& matches, TransferErrors& errors) const;

 private:
  Eigen::Matrix<float, 3, 3, Eigen::RowMajor> H_second_first_, H_first_second_;
};

/// Distances to the epipolar lines, on pixels; E on normalized coordinates.
class EpipolarErrors {
 public:
  EpipolarErrors(const Intrinsics& camera, const Eigen::Matrix3d& E);
  void operator()(const MatchBlock& matches, TransferErrors& errors) const;

 private:
  Eigen::Matrix<float, 3, 3, Eigen::RowMajor> F_;
};

/// What errors leave, and how many matches have both of theirs below the threshold.
struct Left {
  float sum = 0;
  int inliers = 0;
};

/// Sums `whole` less the error over the errors below `threshold` [px^2].
Left whatIsLeft(const TransferErrors& errors, float threshold, float whole);

/// Calls use(match, squared error in the second view, in the first [px^2]) for every match.
template <class Errors, class Use>
void forEachError(const TwoViewMatches& m, const Errors& errors, const Use& use) {
  TransferErrors e;
  for (int i = 0; i < m.size(); i += TransferErrors::block) {
    const MatchBlock block = matchBlock(m, i);
    errors(block, e);
    for (int k = 0; k < block.count; ++k) use(i + k, e.in_second[k], e.in_first[k]);
  }
}

}  // namespace depthscope::slam
