#pragma once
#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "slam/bundle_adjuster.hpp"
#include "slam/projection.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

/// A keyframe, and when it was seen.
struct TimedView {
  Pose T_camera_world;
  double timestamp_s = 0;
};

/// A change of the tissue's shape to first order: the point X is at X + S (X - C), with S symmetric
/// and without trace, for what turns and scales everything alike cannot be told from the camera's
/// motion, and C the middle of all points.
inline constexpr int kShapes = 5;
using Shape = Eigen::Matrix<double, kShapes, 1>;

/// (cos wt, sin wt).
inline Eigen::Vector2d phasor(double frequency_hz, double timestamp_s) {
  const double phase = 2 * std::numbers::pi * frequency_hz * timestamp_s;
  return {std::cos(phase), std::sin(phase)};
}

/// A shape that comes and goes: cosine cos wt + sine sin wt.
struct ShapeRhythm {
  double frequency_hz = 0;
  Shape cosine = Shape::Zero(), sine = Shape::Zero();

  Shape at(double timestamp_s) const {
    const Eigen::Vector2d p = phasor(frequency_hz, timestamp_s);
    return cosine * p.x() + sine * p.y();
  }
};

/// How the pose of a view goes along with the tissue's shape: (w, v) of Pose::retract() for
/// T_camera_world.
struct PoseResponse {
  Vector6d offset;                           // where the tissue is at rest
  Eigen::Matrix<double, 6, kShapes> change;  // what each shape adds
};

/// The normal equations of a map's poses and of a shape of the tissue in each view, points
/// eliminated (as in bundle adjustment: Triggs et al. 2000, section 6). What the map's bundle
/// adjustment has left of the reprojection errors is on their right side.
class ShapeProblem {
 public:
  /// The observations of one point are one behind the other. `views` must outlive this.
  ShapeProblem(const Intrinsics& camera, std::span<const TimedView> views,
               std::span<const Eigen::Vector3d> points,
               std::span<const BaObservation> observations);

  /// Eliminates the poses, before anything is asked for; false where that cannot be done.
  bool eliminatePoses();
  /// The rhythm of a frequency that explains most, and in `gain` by how much it lessens the cost
  /// for each number that it takes, in units of noise; 0 where nothing can be said.
  ShapeRhythm fit(double frequency_hz, double& gain) const;
  /// How poses go along with the shapes that a rhythm gives all views, and each with its own alone.
  std::vector<PoseResponse> responses(const ShapeRhythm& rhythm) const;

 private:
  static constexpr int kBlock = 6 + kShapes;
  using Block = Eigen::Matrix<double, kBlock, kBlock>;
  struct Term {
    int view;
    Eigen::Matrix<double, kBlock, 3> W;
  };

  Eigen::Matrix<double, 3, kShapes> motionWithShapes(const Eigen::Vector3d& point) const;
  void addPoint(const Eigen::Vector3d& point, std::span<const BaObservation> observations);
  void add(int i, int j, const Block& block);
  void add(int i, const Eigen::Matrix<double, kBlock, 1>& b);

  Intrinsics camera_;
  std::span<const TimedView> views_;
  int n_;
  Eigen::Vector3d middle_;
  Eigen::MatrixXd H_poses_;  // after eliminatePoses() its Cholesky factor
  Eigen::MatrixXd H_mixed_, H_shapes_;
  Eigen::VectorXd b_poses_, b_shapes_;
  std::vector<Block> held_;  // per view, points held
  std::vector<Term> seen_;   // of the point at work
  double cost_ = 0;
  int terms_ = 0;
};

}  // namespace depthscope::slam
