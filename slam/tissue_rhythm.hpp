#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "slam/shape_problem.hpp"

namespace depthscope::slam {

/// Tissue that changes its shape in the rhythm of breathing. A ventilated patient breathes steadily
/// (respiratory motion models: McClelland et al. 2013; SLAM with one: Mountney & Yang 2010). The
/// map takes tissue to stand still, and each pose puts up with the shape of its own moment as best
/// it can: with tissue of another shape comes a pose that is off.
class TissueRhythm {
 public:
  /// Looks for a rhythm in what a map's bundle adjustment has left of the reprojection errors, all
  /// poses and points being free to go along; nothing where none stands out. The observations of
  /// one point are one behind the other.
  static std::optional<TissueRhythm> find(const Intrinsics& camera,
                                          std::span<const TimedView> views,
                                          std::span<const Eigen::Vector3d> points,
                                          std::span<const BaObservation> observations);

  double frequency_hz() const { return rhythm_.frequency_hz; }
  /// By how much a camera at the place of `view` is off at a time, because the tissue then had
  /// another shape than the map: (w, v) of Pose::retract() for T_camera_world, which takes that
  /// back.
  Vector6d correction(int view, double timestamp_s) const {
    return responses_[view].offset + responses_[view].change * rhythm_.at(timestamp_s);
  }

 private:
  TissueRhythm(const ShapeRhythm& rhythm, std::vector<PoseResponse> responses)
      : rhythm_(rhythm), responses_(std::move(responses)) {}

  ShapeRhythm rhythm_;
  std::vector<PoseResponse> responses_;  // of each view
};

}  // namespace depthscope::slam
