#pragma once
#include "slam/pose_tracker.hpp"
#include "slam/relocalizer.hpp"

namespace depthscope::slam {

/// Finds the camera again in the map after tracking has failed. Blurred or covered pictures are
/// mostly few, and the scope has not gone far: so first from the last frame that was tracked, then
/// by looking for the place in the whole map. Verifies before it accepts: a wrong pose is worse
/// than none.
class Recovery {
 public:
  Recovery(const CameraModel& camera, const SlamSettings& settings, Map& map,
           const KeyframeDatabase& database, PoseTracker& pose_tracker);

  /// Tracking has failed at `now_s`. `last` is the last frame that was tracked, which is kept (what
  /// is left in its place means nothing); `T_current_last` the motion then, if it is known.
  void begin(TrackedFrame& last, const Pose* T_current_last, double now_s);
  /// Whether the place of `frame` was found: then it has its pose and its points. `last` is the
  /// frame before it.
  bool recover(const TrackedFrame& last, TrackedFrame& frame);

  int inliers() const { return inliers_; }
  /// The frame was found, but on few points: not to be used unless the next one confirms it.
  bool inDoubt() const { return in_doubt_; }
  /// Time since tracking failed [s], of which pictures that show nothing are no part.
  double lostFor_s(double now_s) const { return now_s - lost_since_s_; }

 private:
  bool fromLastTracked(TrackedFrame& frame);
  bool fromDoubt(const TrackedFrame& last, TrackedFrame& frame);
  bool fromWholeMap(TrackedFrame& frame);
  bool foundEnough(const TrackedFrame& frame);

  TrackerSettings settings_;
  CameraModel camera_;
  Map& map_;
  PoseTracker& pose_tracker_;
  Relocalizer relocalizer_;
  TrackedFrame anchor_;  // the last frame that was tracked
  Pose T_current_last_;  // of the camera's motion before
  Pose T_predicted_;     // as if the motion had gone on
  bool predicts_ = false;
  double failed_at_s_ = 0, lost_since_s_ = 0;
  bool in_doubt_ = false;
  int inliers_ = 0;
};

}  // namespace depthscope::slam
