#pragma once
#include <optional>

#include "slam/map_initializer.hpp"
#include "slam/mapper.hpp"
#include "slam/orb_extractor.hpp"
#include "slam/point_carrier.hpp"
#include "slam/pose_tracker.hpp"
#include "slam/recovery.hpp"
#include "types/tracking.hpp"

namespace depthscope::slam {

/// Follows the camera from picture to picture: motion model, then local map, then the decision on a
/// keyframe (Mur-Artal et al. 2015, section V). Owns the time before there is a map (initializer)
/// and after it was lost (relocalizer).
class Tracker {
 public:
  Tracker(const CameraModel& camera, const SlamSettings& settings, Map& map,
          const KeyframeDatabase& database, Mapper& mapper, FrameRecords& records);

  PoseEstimate track(const GrayView& image, std::int64_t frame, double timestamp_s);
  /// Forgets the map and starts to look for a new one.
  void reset();

  /// Whether the last frame's picture is one to keep for reconstruction; see ViewKeeper.
  bool wantsPicture() const { return wants_picture_; }
  ViewOutline view() const { return extractor_.fieldOfView().outline(extractor_.pyramid()); }
  double lastExtractMs() const { return extract_ms_; }
  int lostEvents() const { return lost_events_; }
  int relocalizations() const { return relocalizations_; }

 private:
  int wantedFeatures(double timestamp_s) const;
  void beginFrame(const GrayView& image, std::int64_t frame, double timestamp_s);
  bool initialize();
  bool trackFromLastFrame();
  void handleLoss();
  void resume();
  void startAnew();
  bool follow();
  void followCorrections();
  void finishTracked();
  void offerKeyframe();
  void record(bool keyframe);
  Twist twistSinceLast();
  void refineTwistOfLast();
  bool needsKeyframe() const;
  PoseEstimate report();

  TrackerSettings settings_;
  ExtractorSettings extraction_;
  CameraModel camera_;
  Map& map_;
  Mapper& mapper_;
  FrameRecords& records_;
  OrbExtractor extractor_;
  MapInitializer initializer_;
  PoseTracker pose_tracker_;
  PointCarrier point_carrier_;
  Recovery recovery_;

  TrackedFrame current_, last_;
  Pose T_current_last_;  // of the last two frames tracked: the motion model
  bool has_motion_ = false;
  bool last_had_motion_ = false;
  TrackingState state_ = TrackingState::Initializing;
  Sim3 correction_seen_;  // of the map's, applied to current_
  int corrections_seen_ = 0;
  KeyframeId reference_ = kNone;  // the keyframe that shares most points with the current frame
  int inliers_ = 0;
  bool few_found_ = false;                     // in the last frame, of those that should have been
  std::optional<double> without_map_since_s_;  // while one is to be begun
  int lost_events_ = 0, relocalizations_ = 0;
  bool wants_keyframe_ = false, wants_picture_ = false;
  double extract_ms_ = 0;
};

}  // namespace depthscope::slam
