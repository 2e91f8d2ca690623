#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "slam/local_map.hpp"
#include "slam/matcher.hpp"
#include "slam/pose_optimizer.hpp"
#include "types/camera_model.hpp"

namespace depthscope::slam {

/// A picture on its way through the tracker.
struct TrackedFrame {
  TrackedFrame(int features_capacity, const CameraModel& camera)
      : features(features_capacity, camera), points(features_capacity) {
    features.touch();
  }

  FeatureSet features;
  std::vector<PointRef> points;  // per feature: the map point it was recognised as
  Pose T_camera_world;           // at the time of the middle row
  Twist twist;                   // as far as it is known
  std::int64_t frame = -1;
  double timestamp_s = 0;
  bool tracked = false;
  int inliers = 0;  // points, when it was tracked
  // Of the pose, in (w, v) of Pose::retract [rad, map units], from how well its points agree.
  Matrix6d covariance = Matrix6d::Zero();
  double depth = 0;  // mean, of its points [map units]
};

/// Finds the pose of a frame from map points recognised in it, in the ways a tracker needs
/// (Mur-Artal et al. 2015, sections V.B to V.D). Each method leaves in the frame its pose and the
/// points that agree with it, and returns their number, 0 when there is no pose. Takes the map's
/// mutex for as long as it copies.
class PoseTracker {
 public:
  PoseTracker(const CameraModel& camera, const SlamSettings& settings, Map& map);

  /// Looks for the points of `last` where the pose in `frame` predicts them.
  int trackLastFrame(const TrackedFrame& last, TrackedFrame& frame);
  /// Looks for the points of a keyframe by descriptor alone; starts from the pose in `frame`.
  int trackKeyframe(KeyframeId keyframe, TrackedFrame& frame);
  /// Takes the points that the frame has for what they are; starts from its pose.
  int trackOwnPoints(TrackedFrame& frame);
  /// Looks for all points of the map around, given a frame that has some points and a pose already.
  /// `search_scale` widens the windows, for a pose that is only roughly known.
  int trackLocalMap(TrackedFrame& frame, double search_scale = 1);

  /// The keyframe that shares most points with the frame trackLocalMap() was called for; kNone when
  /// none does.
  KeyframeId reference() const { return local_map_.reference(); }
  /// How many features the last trackLocalMap() might have found: as many as there are, and as
  /// there were points expected in the picture. Of points looked for in a wrong place a few percent
  /// are found by chance.
  int findable(const TrackedFrame& frame) const {
    return std::min(frame.features.size(), static_cast<int>(visible_.size()));
  }
  /// How many points of the local map the frame would show by chance: looked for in wrong places,
  /// beside those where the frame's pose puts them, and found as near there as an inlier must be.
  int foundByChance(const TrackedFrame& frame);
  /// Collects the local map of a frame afresh, for reference(). Map mutex held.
  void collectLocalMap(const TrackedFrame& frame) { local_map_.collect(map_, frame.points); }

 private:
  int matchLastFrame(const TrackedFrame& last, double radius_px, TrackedFrame& frame);
  void projectLastFrame(const TrackedFrame& last, double radius_px, const Pose& T_camera_world,
                        const Twist& twist);
  /// `all`: those, too, that the frame has already.
  void projectLocalMap(const Pose& T_camera_world, const Twist& twist, double search_scale,
                       bool all = false);
  /// Where the frame's points are and what they weigh; those that are gone are taken from it.
  void lookUpPoints(TrackedFrame& frame);
  int optimize(TrackedFrame& frame);
  void shareWeights();
  void countSightings(const TrackedFrame& frame);
  void rememberResiduals(const Pose& T_camera_world);

  SlamSettings settings_;
  CameraModel camera_;
  Intrinsics intrinsics_;
  Map& map_;
  LocalMap local_map_;
  Matcher matcher_;
  std::vector<ProjectedPoint> projected_;
  std::vector<LocalPoint> last_points_;  // points of the last frame, copied
  std::vector<PointRef> visible_;        // local points that were predicted into the picture
  std::vector<PoseObservation> observations_;
  std::vector<int> feature_of_observation_;
  std::vector<PointRef> point_of_observation_;
  std::vector<int> matches_;               // per feature
  std::vector<Eigen::Vector3d> position_;  // per feature, of its map point
  std::vector<float> weight_;              // likewise
  std::vector<std::uint8_t> wanted_;       // per keyframe feature
};

}  // namespace depthscope::slam
