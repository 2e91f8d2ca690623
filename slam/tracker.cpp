#include "slam/tracker.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>

#include "slam/pose_confidence.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {

namespace {
constexpr int kYoungMapKeyframes = 5;     // a map this small is quicker made anew than found again
constexpr double kYoungMapWaits_s = 0.1;  // but a blurred picture or two do not end it
constexpr double kQuickStart_s = 0.25;    // within which a map begins where there is texture
}  // namespace

Tracker::Tracker(const CameraModel& camera, const SlamSettings& settings, Map& map,
                 const KeyframeDatabase& database, Mapper& mapper, FrameRecords& records)
    : settings_(settings.tracker),
      extraction_(settings.extractor),
      camera_(camera),
      map_(map),
      mapper_(mapper),
      records_(records),
      extractor_(settings.extractor, camera),
      initializer_(settings, camera, extractor_),
      pose_tracker_(camera, settings, map),
      point_carrier_(camera, settings, map, extractor_),
      recovery_(camera, settings, map, database, pose_tracker_),
      current_(settings.extractor.capacity(), camera),
      last_(settings.extractor.capacity(), camera) {}

PoseEstimate Tracker::track(const GrayView& image, std::int64_t frame, double timestamp_s) {
  const AllocationScope no_allocations;
  followCorrections();
  beginFrame(image, frame, timestamp_s);
  switch (state_) {
    case TrackingState::Initializing:
      if (initialize()) state_ = TrackingState::Tracking;
      break;
    case TrackingState::Tracking:
      if (follow())
        offerKeyframe();
      else
        handleLoss();
      break;
    case TrackingState::Lost:
      if (recovery_.recover(last_, current_))
        resume();
      else if (!recovery_.inDoubt())
        startAnew();
      break;
  }
  return report();
}

void Tracker::beginFrame(const GrayView& image, std::int64_t frame, double timestamp_s) {
  std::swap(current_, last_);
  if (state_ != TrackingState::Initializing)
    without_map_since_s_.reset();
  else if (!without_map_since_s_)
    without_map_since_s_ = timestamp_s;
  const auto start = std::chrono::steady_clock::now();
  extractor_.extract(image, wantedFeatures(timestamp_s), current_.features);
  extract_ms_ =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  current_.frame = frame;
  current_.timestamp_s = timestamp_s;
  current_.tracked = false;
  current_.twist = {};
  std::fill(current_.points.begin(), current_.points.end(), PointRef{});
  inliers_ = 0;
  wants_keyframe_ = wants_picture_ = false;
}

/// More where few are found again of those that should be, and where no map can be begun: all that
/// follows rests on its first points (Mur-Artal et al. begin with more, too).
int Tracker::wantedFeatures(double timestamp_s) const {
  const bool more =
      without_map_since_s_ ? timestamp_s - *without_map_since_s_ > kQuickStart_s : few_found_;
  return more ? extraction_.capacity() : extraction_.features;
}

bool Tracker::initialize() {
  mapper_.drain();
  mapper_.makeRoom(2);
  {
    const std::lock_guard lock(map_.mutex);
    if (!initializer_.offer(current_.features, current_.frame, current_.timestamp_s, map_))
      return false;
  }
  mapper_.adoptInitialMap();
  const std::lock_guard lock(map_.mutex);
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (map_.keyframe(k).alive && map_.keyframe(k).frame == current_.frame) reference_ = k;
  const Keyframe& k = map_.keyframe(reference_);
  for (int f = 0; f < k.features.size(); ++f) {
    if (k.points[f] == kNone) continue;
    current_.points[f] = map_.ref(k.points[f]);
    ++inliers_;
  }
  current_.T_camera_world = k.T_camera_world;
  current_.tracked = true;
  current_.inliers = inliers_;
  current_.depth = 0;
  few_found_ = has_motion_ = false;
  record(true);
  return true;
}

bool Tracker::follow() {
  const std::lock_guard world_stands_still(map_.world_mutex);
  if (!trackFromLastFrame()) return false;
  finishTracked();
  return true;
}

/// Takes the last pose along when the mapper has moved the world since.
void Tracker::followCorrections() {
  const std::lock_guard lock(map_.mutex);
  if (corrections_seen_ == map_.corrections()) return;
  const Sim3 T_new_old = map_.correction() * correction_seen_.inverse();
  current_.T_camera_world = T_new_old.moved(current_.T_camera_world);
  current_.twist.v *= T_new_old.s;
  T_current_last_.t *= T_new_old.s;
  correction_seen_ = map_.correction();
  corrections_seen_ = map_.corrections();
}

bool Tracker::trackFromLastFrame() {
  current_.T_camera_world =
      has_motion_ ? T_current_last_ * last_.T_camera_world : last_.T_camera_world;
  current_.twist = has_motion_ ? last_.twist : Twist{};
  int found = pose_tracker_.trackLastFrame(last_, current_);
  if (found < settings_.carry_below && point_carrier_.carry(last_, current_) > 0)
    found = pose_tracker_.trackOwnPoints(current_);
  if (found < settings_.min_motion_inliers) {
    current_.T_camera_world = last_.T_camera_world;
    found = reference_ == kNone ? 0 : pose_tracker_.trackKeyframe(reference_, current_);
  }
  if (found < settings_.min_motion_inliers || found < settings_.min_found_again * last_.inliers)
    return false;
  current_.twist = twistSinceLast();
  inliers_ = pose_tracker_.trackLocalMap(current_);
  return inliers_ >= settings_.min_inliers &&
         inliers_ >= settings_.min_found * pose_tracker_.findable(current_);
}

void Tracker::handleLoss() {
  ++lost_events_;
  few_found_ = false;
  recovery_.begin(last_, has_motion_ ? &T_current_last_ : nullptr, current_.timestamp_s);
  has_motion_ = false;
  initializer_.reset();
  mapper_.drain();
  state_ = TrackingState::Lost;
}

void Tracker::resume() {
  ++relocalizations_;
  state_ = TrackingState::Tracking;
  inliers_ = recovery_.inliers();
  {
    const std::lock_guard lock(map_.mutex);
    map_.activate(map_.keyframe(pose_tracker_.reference()).map_id);
  }
  finishTracked();
  offerKeyframe();
}

/// Looks for a new map when the old one has been lost long enough.
void Tracker::startAnew() {
  const double lost_s = recovery_.lostFor_s(current_.timestamp_s);
  if (lost_s > kYoungMapWaits_s) {
    const std::lock_guard lock(map_.mutex);
    if (map_.keyframesOf(map_.activeId()) <= kYoungMapKeyframes) {
      records_.dropMap(map_, map_.activeId());
      map_.removeMap(map_.activeId());
    }
    if (map_.keyframeCount() == 0) state_ = TrackingState::Initializing;
  }
  if ((state_ == TrackingState::Initializing || lost_s >= settings_.new_map_after_s) &&
      initialize())
    state_ = TrackingState::Tracking;
}

void Tracker::reset() {
  mapper_.drain();
  const std::lock_guard lock(map_.mutex);
  map_.clear();
  records_.clear();
  initializer_.reset();
  state_ = TrackingState::Initializing;
  has_motion_ = false;
  reference_ = kNone;
}

void Tracker::finishTracked() {
  current_.tracked = true;
  current_.inliers = inliers_;
  few_found_ = inliers_ < settings_.weak_below && 2 * inliers_ < pose_tracker_.findable(current_);
  last_had_motion_ = has_motion_;
  has_motion_ = last_.tracked;
  if (has_motion_) T_current_last_ = current_.T_camera_world * last_.T_camera_world.inverse();
  current_.twist = twistSinceLast();
  const std::lock_guard lock(map_.mutex);
  if (has_motion_) refineTwistOfLast();
  reference_ = pose_tracker_.reference();
  // The mapper may have dropped it meanwhile.
  if (reference_ == kNone || !map_.keyframe(reference_).alive) {
    pose_tracker_.collectLocalMap(current_);
    reference_ = pose_tracker_.reference();
  }
  if (reference_ == kNone) return;
  wants_keyframe_ = needsKeyframe();
  record(wants_keyframe_);
}

/// Zero where the last frame was not tracked.
Twist Tracker::twistSinceLast() {
  const double seconds = current_.timestamp_s - last_.timestamp_s;
  if (!last_.tracked || !(seconds > 0)) return {};
  map_.shutter().noteInterval(seconds);
  return twistBetween(last_.T_camera_world, current_.T_camera_world, seconds);
}

/// If the last frame became a keyframe, its motion is known better now: half of it lies before and
/// half after it. Map mutex held.
void Tracker::refineTwistOfLast() {
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k) {
    Keyframe& keyframe = map_.keyframe(k);
    if (!keyframe.alive || keyframe.frame != last_.frame) continue;
    const Twist &before = last_.twist, &after = current_.twist;
    keyframe.twist =
        last_had_motion_ ? Twist{(before.w + after.w) / 2, (before.v + after.v) / 2} : after;
  }
}

/// What frame this was, where, and whether its picture is kept. Map mutex held.
void Tracker::record(bool keyframe) {
  AnchoredPose pose;
  pose.frame = current_.frame;
  pose.timestamp_s = current_.timestamp_s;
  pose.anchor(map_, reference_,
              current_.T_camera_world * map_.keyframe(reference_).T_camera_world.inverse());
  records_.trajectory.add(pose);
  const double depth = current_.depth > 0 ? current_.depth : map_.medianDepth(reference_);
  wants_picture_ = records_.views.offer(map_, pose, depth, keyframe);
}

void Tracker::offerKeyframe() {
  if (wants_keyframe_)
    mapper_.submit(current_.features, std::span(current_.points).first(current_.features.size()),
                   current_.T_camera_world, correction_seen_, current_.frame, current_.timestamp_s,
                   current_.twist);
}

/// Map mutex held.
bool Tracker::needsKeyframe() const {
  if (!mapper_.idle()) return false;
  int reference_points = 0;
  for (const PointId p : map_.keyframe(reference_).points) reference_points += p != kNone;
  return inliers_ < settings_.keyframe_ratio * reference_points;
}

PoseEstimate Tracker::report() {
  followCorrections();  // the mapper may have worked in this call
  PoseEstimate e;
  e.frame = current_.frame;
  e.timestamp_s = current_.timestamp_s;
  e.state = state_;
  e.map_id = map_.activeId();
  if (state_ != TrackingState::Tracking) return e;
  e.T_camera_world = current_.T_camera_world;
  e.inliers = inliers_;
  e.confidence = poseConfidence(current_, inliers_, 3 * settings_.min_inliers, camera_);
  return e;
}

}  // namespace depthscope::slam
