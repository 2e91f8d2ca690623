#pragma once
#include <vector>

#include "slam/orb_extractor.hpp"
#include "slam/pose_tracker.hpp"
#include "slam/spare_features.hpp"

namespace depthscope::slam {

/// Carries map points from picture to picture by optical flow where descriptors fail to find them:
/// on tissue with little texture corners come and go, and what they look like is mostly noise
/// (SD-DefSLAM, Gomez-Rodriguez et al. 2021, section III).
class PointCarrier {
 public:
  /// `extractor` is the one that `frame` and `last` come from.
  PointCarrier(const CameraModel& camera, const SlamSettings& settings, Map& map,
               const OrbExtractor& extractor);

  /// Looks for the points of `last`, the picture before `frame`, that `frame` has not, from where
  /// its pose predicts them. Each one found becomes a feature of `frame`; when it is full, in place
  /// of the weakest corner that has no point. Returns their number. Takes the map's mutex for as
  /// long as it copies.
  int carry(const TrackedFrame& last, TrackedFrame& frame);

 private:
  /// A point with its feature in the last picture.
  struct Carried {
    PointRef ref;
    Eigen::Vector3d position;
    int feature;
  };
  void collectMissing(const TrackedFrame& last, const TrackedFrame& frame);
  bool carry(const Carried& point, const TrackedFrame& last, TrackedFrame& frame, int slot) const;

  CameraModel camera_;
  double flow_sigma_px_;
  Map& map_;
  const OrbExtractor& extractor_;
  std::vector<Carried> missing_;
  SpareFeatures spare_;
  std::vector<std::int64_t> stamp_;  // per point: carry() that last found it in the frame
  std::int64_t current_stamp_ = 0;
};

}  // namespace depthscope::slam
