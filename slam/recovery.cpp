#include "slam/recovery.hpp"

#include <algorithm>
#include <mutex>

#include "slam/pose_confidence.hpp"

namespace depthscope::slam {

namespace {
constexpr int kMinFeaturesOfAPicture = 100;  // fewer: dark, fogged or covered
constexpr double kMotionHolds_s = 0.2;       // so long a hand may go on as it went
constexpr double kNear_s = 0.35;             // so long it is near where it was
constexpr double kFoundAgain = 0.2;          // of the points of the last frame tracked
constexpr float kMinSpread = 0.3f;           // of points carried over from the last frame tracked
// Of a place found in the whole map. Where the scope came back from behind 45 black pictures with
// its view turned by 10 to 35 degrees, right poses rested on 26 to 60 points of a thousand.
constexpr double kMinFoundOfMap = 0.02;
constexpr float kMinSpreadOfMap = 0.25f;
// Where the local map has so many points that some match anywhere, a wrong pose collects them. In
// 1200 pictures of places never seen (four clips that go on mirrored) 28 poses were looked at, and
// the best had 43 points, 7 times as many as are found beside where it put them; right poses in
// three clips with gaps have 10 to 50 times as many.
constexpr int kOverChance = 8;
// Bound the time spent on one lost frame: a keyframe takes about 0.6 ms, to begin a map 2.5.
constexpr int kKeyframesPerFrame = 8;
constexpr int kKeyframesBesideNewMap = 4;
constexpr int kSureInliers = 100;  // fewer: the next picture must agree
constexpr float kSureSpread = 0.5f;
}  // namespace

Recovery::Recovery(const CameraModel& camera, const SlamSettings& settings, Map& map,
                   const KeyframeDatabase& database, PoseTracker& pose_tracker)
    : settings_(settings.tracker),
      camera_(camera),
      map_(map),
      pose_tracker_(pose_tracker),
      relocalizer_(settings, map.intrinsics(), database),
      anchor_(settings.extractor.capacity(), camera) {}

void Recovery::begin(TrackedFrame& last, const Pose* T_current_last, double now_s) {
  std::swap(last, anchor_);
  last.tracked = false;
  predicts_ = T_current_last != nullptr;
  if (predicts_) {
    T_current_last_ = *T_current_last;
    T_predicted_ = T_current_last_ * anchor_.T_camera_world;
  }
  failed_at_s_ = lost_since_s_ = now_s;
  in_doubt_ = false;
  relocalizer_.restart();
}

bool Recovery::recover(const TrackedFrame& last, TrackedFrame& frame) {
  // A scope that is withdrawn, wiped or covered shows nothing to go by: its time begins when there
  // is a picture again.
  if (predicts_) T_predicted_ = T_current_last_ * T_predicted_;
  inliers_ = 0;
  if (frame.features.size() < kMinFeaturesOfAPicture) {
    lost_since_s_ = frame.timestamp_s;
    in_doubt_ = false;
    return false;
  }
  if (fromDoubt(last, frame)) return true;
  return fromLastTracked(frame) || fromWholeMap(frame);
}

/// What was found in the last frame and left in doubt must hold in this one.
bool Recovery::fromDoubt(const TrackedFrame& last, TrackedFrame& frame) {
  if (!in_doubt_) return false;
  in_doubt_ = false;
  frame.T_camera_world = last.T_camera_world;
  if (pose_tracker_.trackLastFrame(last, frame) < settings_.min_motion_inliers) return false;
  inliers_ = pose_tracker_.trackLocalMap(frame);
  return foundEnough(frame);
}

bool Recovery::foundEnough(const TrackedFrame& frame) {
  return inliers_ >= settings_.min_inliers_relocalized &&
         inliers_ >= kMinFoundOfMap * pose_tracker_.findable(frame) &&
         inliers_ >= kOverChance * pose_tracker_.foundByChance(frame);
}

bool Recovery::fromLastTracked(TrackedFrame& frame) {
  const double gap_s = frame.timestamp_s - failed_at_s_;
  if (gap_s > kNear_s) return false;
  for (const bool moved : {true, false}) {
    if (moved && (!predicts_ || gap_s > kMotionHolds_s)) continue;
    frame.T_camera_world = moved ? T_predicted_ : anchor_.T_camera_world;
    const int found = pose_tracker_.trackLastFrame(anchor_, frame);
    if (found < settings_.min_motion_inliers || found < kFoundAgain * anchor_.inliers) continue;
    inliers_ = pose_tracker_.trackLocalMap(frame);
    if (inliers_ >= settings_.min_inliers && inlierSpread(frame, camera_) >= kMinSpread)
      return true;
  }
  return false;
}

bool Recovery::fromWholeMap(TrackedFrame& frame) {
  constexpr double kWideSearch = 4;
  const bool new_map_too = lostFor_s(frame.timestamp_s) >= settings_.new_map_after_s;
  {
    const std::lock_guard lock(map_.mutex);
    if (!relocalizer_.relocalize(map_, frame.features,
                                 new_map_too ? kKeyframesBesideNewMap : kKeyframesPerFrame,
                                 frame.T_camera_world, frame.points))
      return false;
  }
  // First in wide windows, as the pose rests on few points; then as strictly as ever.
  pose_tracker_.trackLocalMap(frame, kWideSearch);
  inliers_ = pose_tracker_.trackLocalMap(frame);
  const float spread = inlierSpread(frame, camera_);
  if (!foundEnough(frame) || spread < kMinSpreadOfMap) return false;
  in_doubt_ = inliers_ < kSureInliers || spread < kSureSpread;
  return !in_doubt_;
}

}  // namespace depthscope::slam
