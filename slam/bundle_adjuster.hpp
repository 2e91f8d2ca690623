#pragma once
#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slam/block_cholesky.hpp"
#include "slam/projection.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

struct BaPose {
  Pose T_camera_world;
  bool fixed = false;  // holds the gauge: at least one pose should be, better two
};

/// Pose `pose` sees point `point` at `pixel`: indices as returned by addPose and addPoint.
struct BaObservation {
  std::int32_t pose = 0;
  std::int32_t point = 0;
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  // undistorted [px]
  float inv_sigma2 = 1;                             // [1/px^2], times the trust in the point
  bool inlier = true;                               // in: takes part; out: verdict
  // By how much the pixel is seen off when a parameter that all observations share is off by one.
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();  // [px / unit of the parameter]
};

/// One observation says nothing about a free point, nor it of a pose.
inline constexpr int kMinTermsOfPoint = 2;

/// By how much a parameter that all observations share is off: what is to be added to it, and the
/// standard deviation of that.
struct BaShared {
  double offset = 0, sigma = 0;
};

struct BaSettings {
  int max_iterations = 10;
  double chi2_inlier =
      kChi2TwoDof95;             // Huber's threshold, squared, and that of the verdict [sigma^2]
  double initial_lambda = 1e-4;  // Levenberg-Marquardt damping, relative to the diagonal
  double min_relative_decrease = 1e-5;  // of the cost: below it, it has converged
};

struct BaSummary {
  enum class End { Converged, IterationLimit, Stopped, Failed };
  End end = End::Failed;  // Failed: nothing to adjust, or not a number in what was given
  int iterations = 0;     // steps taken
  double initial_cost = 0, final_cost = 0;  // robust, [sigma^2]
  int inliers = 0, outliers = 0;
  double rms_px = 0;  // of the inliers, whitened: pixels at the level a point was found in
};

/// Bundle adjustment of keyframe poses and points (Triggs et al. 2000): Levenberg-Marquardt under
/// Huber's cost, points eliminated by the Schur complement. All storage is allocated by the
/// constructor. Use: clear(), add poses, points and observations, solve(), read them back.
class BundleAdjuster {
 public:
  BundleAdjuster(int max_poses, int max_points, int max_observations);

  void clear();
  /// Each returns the index of what was added, or -1 when its capacity is used up.
  int addPose(const Pose& T_camera_world, bool fixed);
  int addPoint(const Eigen::Vector3d& point_world);
  /// Precondition: pose and point have been added; at most one observation for a pair of them.
  int addObservation(const BaObservation& observation);
  int freeObservations() const {
    return static_cast<int>(observations_.capacity() - observations_.size());
  }

  /// Adjusts what was added in place and sets `inlier` of every observation. `stop`, if given, is
  /// looked at before each iteration: what has been gained until then is kept.
  BaSummary solve(const Intrinsics& camera, const BaSettings& settings = {},
                  const std::atomic<bool>* stop = nullptr);

  /// After solve(): how far the parameter behind BaObservation::shift is from where the
  /// observations want it, poses and points being free to go along; nothing when they do not say.
  /// Adjusts nothing.
  std::optional<BaShared> estimateShared(const Intrinsics& camera, const BaSettings& settings = {});

  std::span<BaPose> poses() { return poses_; }
  std::span<Eigen::Vector3d> points() { return points_; }
  std::span<BaObservation> observations() { return observations_; }
  std::size_t bytes() const;  // allocated by the constructor

 private:
  using Matrix63 = Eigen::Matrix<double, 6, 3>;

  /// An observation that takes part, in order of its point.
  struct Term {
    Eigen::Vector2d pixel;
    double inv_sigma2;
    std::int32_t pose;
    std::int32_t block;  // free pose index, -1: fixed
    Eigen::Vector2f shift;
  };
  struct PointBlock {
    Eigen::Matrix3d H;      // sum of J^T W J over its observations
    Eigen::Vector3d b;      // minus the gradient
    Eigen::Matrix3d L_inv;  // of the damped H = L L^T; zero: the point is held
  };

  void indexProblem();
  void linearize(const Intrinsics& camera, double huber_delta);
  void linearizePoint(const Intrinsics& camera, double huber_delta, int point);
  bool computeStep(double lambda);
  void eliminatePoint(int point, double lambda);
  void backSubstitute();
  void borderPoint(const Intrinsics& camera, double huber_delta, int point);
  double predictedDecrease(double lambda) const;
  void applyStep();
  double cost(const Intrinsics& camera, double huber_delta, std::span<const BaPose> poses,
              std::span<const Eigen::Vector3d> points) const;
  void classify(const Intrinsics& camera, double chi2_inlier, BaSummary& summary);

  std::vector<BaPose> poses_, candidate_poses_;
  std::vector<Eigen::Vector3d> points_, candidate_points_;
  std::vector<BaObservation> observations_;

  int free_poses_ = 0;
  std::vector<std::int32_t> block_of_pose_;  // -1: fixed
  std::vector<std::int32_t> first_term_;     // per point, and one more
  std::vector<Term> terms_;
  std::vector<Matrix63> W_;  // per term: pose by point block of J^T W J
  std::vector<PointBlock> point_blocks_;
  std::vector<Eigen::Vector3d> point_step_;
  std::vector<Matrix6d> pose_H_;  // per free pose: sum of J^T W J
  std::vector<Vector6d> pose_b_, pose_step_;
  std::vector<Matrix63> eliminated_;  // scratch, for the observations of one point
  BlockCholesky reduced_;             // camera system
  // The row that the shared parameter adds to it, points eliminated.
  std::vector<Vector6d> border_, border_solved_;  // per free pose
  double border_H_ = 0, border_b_ = 0;
};

}  // namespace depthscope::slam
