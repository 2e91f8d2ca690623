#pragma once
#include <vector>

#include "slam/local_map.hpp"
#include "slam/map_initializer.hpp"
#include "slam/mapper.hpp"
#include "slam/matcher.hpp"
#include "slam/orb_extractor.hpp"
#include "slam/pose_optimizer.hpp"
#include "slam/relocalizer.hpp"
#include "types/tracking.hpp"

namespace depthscope::slam {

/// A picture on its way through the tracker.
struct TrackedFrame {
  FeatureSet features;
  std::vector<PointRef> points;   // per feature: the map point it was recognised as
  Pose T_camera_world;
  std::int64_t frame = -1;
  double timestamp_s = 0;
  bool tracked = false;
};

/// Follows the camera from picture to picture: motion model, then local map, then the decision on a keyframe
/// (Mur-Artal et al. 2015, section V). Owns the time before there is a map (initializer) and after it was lost (relocalizer).
class Tracker {
 public:
  Tracker(const CameraModel& camera, const SlamSettings& settings, Map& map, Mapper& mapper, Trajectory& trajectory);

  PoseEstimate track(const GrayView& image, std::int64_t frame, double timestamp_s);
  /// Forgets the map and starts to look for a new one.
  void reset();

  double lastExtractMs() const { return extract_ms_; }
  int lostEvents() const { return lost_events_; }
  int relocalizations() const { return relocalizations_; }
  int mapsStarted() const { return maps_started_; }

 private:
  bool initialize();
  bool trackMotionModel();
  bool trackReferenceKeyframe();
  bool trackLocalMap(int min_inliers);
  bool relocalize();
  void handleLoss();
  bool needsKeyframe() const;
  void makeKeyframe();
  void finishTracked();

  int matchLastFrame(double radius_px);
  void projectLastFrame(double radius_px);
  void projectLocalMap();
  int optimize();
  void countSightings();
  float confidence() const;
  PoseEstimate report() const;

  SlamSettings settings_;
  CameraModel camera_;
  Intrinsics intrinsics_;
  Map& map_;
  Mapper& mapper_;
  Trajectory& trajectory_;
  OrbExtractor extractor_;
  MapInitializer initializer_;
  Relocalizer relocalizer_;
  LocalMap local_map_;
  Matcher matcher_;

  TrackedFrame current_, last_;
  Pose velocity_;                 // T_camera_previous of the last two frames
  bool has_velocity_ = false;
  TrackingState state_ = TrackingState::Initializing;
  KeyframeId reference_ = kNone;
  double last_keyframe_s_ = 0;
  int inliers_ = 0;
  int lost_events_ = 0, relocalizations_ = 0, maps_started_ = 0;
  double extract_ms_ = 0;

  std::vector<ProjectedPoint> projected_;
  std::vector<LocalPoint> last_points_;        // points of the last frame, copied
  std::vector<PoseObservation> observations_;
  std::vector<int> feature_of_observation_;
  std::vector<int> matches_;                   // per feature
  std::vector<Eigen::Vector3d> position_;      // per feature, of its map point
  std::vector<PointRef> visible_;              // local points that were predicted into the picture
  std::vector<std::uint8_t> wanted_;
};

}  // namespace depthscope::slam
