#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "slam/features.hpp"
#include "slam/intrinsics.hpp"

namespace depthscope::slam {

/// Tells right matches between two views from wrong ones without knowing the pose: right ones are
/// turned and shifted in the picture much alike, wrong ones anyhow (clusters in pose space: Lowe
/// 2004, section 7.3). Right ones may then be few among many: of tissue, which looks alike
/// everywhere, a tenth. Room for a fixed number of features.
class CommonShift {
 public:
  /// Of pictures of that camera, whose axis goes through about their middle.
  CommonShift(const Intrinsics& camera, int max_features);

  /// Keeps of `matches` (index into `second` for each feature of `first`, or negative) those of the
  /// fullest cluster, makes the others -1, and returns how many are kept.
  int keep(const FeatureSet& first, const FeatureSet& second, std::span<int> matches);

 private:
  struct Match {
    int feature;
    float turn;                     // [rad] of the patch, 0..2 pi
    Eigen::Vector2f first, second;  // places [px], from the middle of the picture
    Eigen::Vector2f shift;          // [px] when the turn at work has been undone
  };

  void takeTurned(float turn);
  void takeFullest();

  Eigen::Vector2f middle_;
  float reach_;                 // [px] of a cluster
  std::vector<Match> all_;      // the matches
  std::vector<Match> turned_;   // of these, those of the turn at work
  std::vector<Match> cluster_;  // of these, the fullest cluster
};

}  // namespace depthscope::slam
