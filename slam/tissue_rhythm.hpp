#pragma once
#include <Eigen/Core>
#include <optional>
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

/// Tissue that changes its shape in the rhythm of breathing, to first order: at time t the point X
/// is at X + (A cos wt + B sin wt) (X - C), with A and B symmetric and without trace, for what
/// turns and scales everything alike cannot be told from the camera's motion. A ventilated patient
/// breathes steadily (respiratory motion models: McClelland et al. 2013; SLAM with one: Mountney &
/// Yang 2010). The map takes tissue to stand still, and each pose puts up with the shape of its own
/// moment as best it can: with tissue of another shape comes a pose that is off.
class TissueRhythm {
 public:
  /// Looks for a rhythm in what a map's bundle adjustment has left of the reprojection errors, all
  /// poses and points being free to go along; nothing where none stands out. The observations of
  /// one point are one behind the other.
  static std::optional<TissueRhythm> find(const Intrinsics& camera,
                                          std::span<const TimedView> views,
                                          std::span<const Eigen::Vector3d> points,
                                          std::span<const BaObservation> observations);

  double frequency_hz() const { return frequency_hz_; }
  /// By how much a camera at the place of `view` is off at a time, because the tissue then had
  /// another shape than the map: (w, v) of Pose::retract() for T_camera_world, which takes that
  /// back.
  Vector6d correction(int view, double timestamp_s) const;

 private:
  static constexpr int kShapes = 5;  // symmetric matrices without trace
  using Shape = Eigen::Matrix<double, kShapes, 1>;
  using PoseOfShape = Eigen::Matrix<double, 6, kShapes>;
  class Problem;

  Shape shapeAt(double timestamp_s) const;

  double frequency_hz_ = 0;
  Shape cosine_ = Shape::Zero(), sine_ = Shape::Zero();
  std::vector<Vector6d> offset_;           // per view: correction where the tissue is at rest
  std::vector<PoseOfShape> of_the_shape_;  // per view: and what each shape adds to it
};

}  // namespace depthscope::slam
