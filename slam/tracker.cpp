#include "slam/tracker.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <mutex>

#include "types/allocation_scope.hpp"

namespace depthscope::slam {

Tracker::Tracker(const CameraModel& camera, const SlamSettings& settings, Map& map, Mapper& mapper,
                 Trajectory& trajectory)
    : settings_(settings),
      camera_(camera),
      intrinsics_{camera.fx, camera.fy, camera.cx, camera.cy},
      map_(map),
      mapper_(mapper),
      trajectory_(trajectory),
      extractor_(settings.extractor, camera),
      initializer_(settings, camera),
      relocalizer_(settings, camera),
      local_map_(settings),
      matcher_(settings.matching, settings.extractor.features) {
  const int n = settings.extractor.features;
  for (TrackedFrame* f : {&current_, &last_}) {
    f->features = FeatureSet(n, camera);
    f->points.resize(n);
  }
  projected_.reserve(settings.capacity.local_points);
  visible_.reserve(settings.capacity.local_points);
  last_points_.reserve(n);
  observations_.reserve(n);
  feature_of_observation_.reserve(n);
  matches_.resize(n);
  position_.resize(n);
  wanted_.resize(n);
}

PoseEstimate Tracker::track(const GrayView& image, std::int64_t frame, double timestamp_s) {
  const AllocationScope no_allocations;
  std::swap(current_, last_);
  const auto start = std::chrono::steady_clock::now();
  extractor_.extract(image, current_.features);
  extract_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  current_.frame = frame;
  current_.timestamp_s = timestamp_s;
  current_.tracked = false;
  std::fill(current_.points.begin(), current_.points.end(), PointRef{});
  inliers_ = 0;

  switch (state_) {
    case TrackingState::Initializing:
      if (initialize()) state_ = TrackingState::Tracking;
      break;
    case TrackingState::Tracking:
      if ((trackMotionModel() || trackReferenceKeyframe()) && trackLocalMap(settings_.tracker.min_inliers))
        finishTracked();
      else
        handleLoss();
      break;
    case TrackingState::Lost:
      if (relocalize()) {
        ++relocalizations_;
        state_ = TrackingState::Tracking;
        finishTracked();
      }
      break;
  }
  return report();
}

bool Tracker::initialize() {
  {
    const std::lock_guard lock(map_.mutex);
    if (!initializer_.offer(current_.features, current_.frame, current_.timestamp_s, map_)) return false;
  }
  mapper_.adoptInitialMap();
  const std::lock_guard lock(map_.mutex);
  ++maps_started_;
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
  has_velocity_ = false;
  last_keyframe_s_ = current_.timestamp_s;
  trajectory_.add(current_.frame, current_.timestamp_s, reference_, Pose{});
  return true;
}

bool Tracker::trackMotionModel() {
  current_.T_camera_world = has_velocity_ ? velocity_ * last_.T_camera_world : last_.T_camera_world;
  const double radius = settings_.matching.motion_radius_px;
  int matched = matchLastFrame(radius);
  if (matched < 2 * settings_.tracker.min_motion_inliers) matched = matchLastFrame(2 * radius);
  if (matched < 2 * settings_.tracker.min_motion_inliers) return false;
  return optimize() >= settings_.tracker.min_motion_inliers;
}

int Tracker::matchLastFrame(double radius_px) {
  projectLastFrame(radius_px);
  std::fill(matches_.begin(), matches_.end(), kNone);
  const int matched = matcher_.matchProjected(current_.features, projected_, settings_.matching.hamming_loose, 1.0, matches_);
  for (int f = 0; f < current_.features.size(); ++f) {
    current_.points[f] = {};
    if (matches_[f] < 0) continue;
    const LocalPoint& p = last_points_[projected_[matches_[f]].source];
    current_.points[f] = p.ref;
    position_[f] = p.position;
  }
  return matched;
}

void Tracker::projectLastFrame(double radius_px) {
  last_points_.clear();
  projected_.clear();
  const std::lock_guard lock(map_.mutex);
  for (int f = 0; f < last_.features.size(); ++f) {
    const PointId id = map_.resolve(last_.points[f]);
    if (id == kNone) continue;
    const Eigen::Vector3d p = current_.T_camera_world * map_.point(id).position;
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector2d px = intrinsics_.project(p);
    const int octave = last_.features.keypoints[f].octave;
    projected_.push_back({last_.features.descriptors[f], static_cast<float>(px.x()), static_cast<float>(px.y()),
                          static_cast<float>(radius_px) * map_.scaleOf(octave), octave - 1, octave + 1,
                          static_cast<std::int32_t>(last_points_.size())});
    last_points_.push_back(makeLocalPoint(map_, id));
  }
}

bool Tracker::trackReferenceKeyframe() {
  if (reference_ == kNone) return false;
  {
    const std::lock_guard lock(map_.mutex);
    const Keyframe& k = map_.keyframe(reference_);
    if (!k.alive) return false;
    for (int f = 0; f < k.features.size(); ++f) wanted_[f] = k.points[f] != kNone;
    const int matched = matcher_.matchByDescriptor(k.features, wanted_, current_.features,
                                                   settings_.matching.hamming_strict, 0.7, matches_);
    if (matched < 15) return false;
    std::fill(current_.points.begin(), current_.points.end(), PointRef{});
    for (int f = 0; f < k.features.size(); ++f) {
      if (matches_[f] < 0) continue;
      current_.points[matches_[f]] = map_.ref(k.points[f]);
      position_[matches_[f]] = map_.point(k.points[f]).position;
    }
  }
  current_.T_camera_world = last_.T_camera_world;
  return optimize() >= settings_.tracker.min_motion_inliers;
}

bool Tracker::trackLocalMap(int min_inliers) {
  {
    const std::lock_guard lock(map_.mutex);
    local_map_.collect(map_, current_.points);
  }
  if (local_map_.reference() != kNone) reference_ = local_map_.reference();
  projectLocalMap();
  for (int f = 0; f < current_.features.size(); ++f) matches_[f] = current_.points[f].id == kNone ? kNone : kTaken;
  matcher_.matchProjected(current_.features, projected_, settings_.matching.hamming_loose, settings_.matching.ratio, matches_);
  for (int f = 0; f < current_.features.size(); ++f) {
    if (matches_[f] < 0) continue;
    const LocalPoint& p = local_map_.points()[projected_[matches_[f]].source];
    current_.points[f] = p.ref;
    position_[f] = p.position;
  }
  inliers_ = optimize();
  countSightings();
  return inliers_ >= min_inliers;
}

void Tracker::projectLocalMap() {
  constexpr double kNearlyFrontalCos = 0.998;  // a narrower window is enough then
  constexpr double kMaxViewAngleCos = 0.5;     // 60 degrees from the mean viewing direction
  projected_.clear();
  visible_.clear();
  const Pose& T = current_.T_camera_world;
  const Eigen::Matrix3d R_world_camera = T.R.transpose();
  const auto points = local_map_.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LocalPoint& lp = points[i];
    const Eigen::Vector3d p = T * lp.position;
    if (p.z() < kMinDepth) continue;
    const Eigen::Vector2d px = camera_.project(p);
    if (px.x() < 0 || px.y() < 0 || px.x() > camera_.width - 1 || px.y() > camera_.height - 1) continue;
    const double distance = p.norm();
    if (distance < 0.8 * lp.min_distance || distance > 1.2 * lp.max_distance) continue;
    const double cos_view = (R_world_camera * p).dot(lp.normal.cast<double>()) / distance;
    if (cos_view < kMaxViewAngleCos) continue;
    visible_.push_back(lp.ref);
    const Eigen::Vector2d upx = intrinsics_.project(p);
    const int level = std::clamp(static_cast<int>(std::ceil(std::log(lp.max_distance / distance) /
                                                            std::log(settings_.extractor.scale_factor))),
                                 0, settings_.extractor.levels - 1);
    const double radius = settings_.matching.map_radius_px * (cos_view > kNearlyFrontalCos ? 0.625 : 1.0);
    projected_.push_back({lp.descriptor, static_cast<float>(upx.x()), static_cast<float>(upx.y()),
                          static_cast<float>(radius) * map_.scaleOf(level), level - 1, level,
                          static_cast<std::int32_t>(i)});
  }
}

int Tracker::optimize() {
  observations_.clear();
  feature_of_observation_.clear();
  for (int f = 0; f < current_.features.size(); ++f) {
    if (current_.points[f].id == kNone) continue;
    const Keypoint& k = current_.features.keypoints[f];
    observations_.push_back({position_[f], {k.ux, k.uy}, 1 / (k.sigma * k.sigma), 1, true});
    feature_of_observation_.push_back(f);
  }
  const PoseOptimizerResult result = optimizePose(intrinsics_, observations_, current_.T_camera_world);
  if (!result.ok) return 0;
  for (std::size_t i = 0; i < observations_.size(); ++i)
    if (!observations_[i].inlier) current_.points[feature_of_observation_[i]] = {};
  return result.inliers;
}

void Tracker::countSightings() {
  const std::lock_guard lock(map_.mutex);
  for (const PointRef& r : visible_)
    if (const PointId p = map_.resolve(r); p != kNone) ++map_.point(p).visible;
  for (int f = 0; f < current_.features.size(); ++f)
    if (const PointId p = map_.resolve(current_.points[f]); p != kNone) ++map_.point(p).found;
}

bool Tracker::relocalize() {
  {
    const std::lock_guard lock(map_.mutex);
    if (!relocalizer_.relocalize(map_, current_.features, current_.T_camera_world, current_.points)) return false;
    for (int f = 0; f < current_.features.size(); ++f)
      if (const PointId p = map_.resolve(current_.points[f]); p != kNone) position_[f] = map_.point(p).position;
  }
  return trackLocalMap(settings_.tracker.min_inliers_relocalized);
}

void Tracker::handleLoss() {
  constexpr int kYoungMapKeyframes = 5;  // a map this small is quicker made anew than found again
  ++lost_events_;
  has_velocity_ = false;
  state_ = TrackingState::Lost;
  bool young;
  {
    const std::lock_guard lock(map_.mutex);
    young = map_.keyframeCount() <= kYoungMapKeyframes;
  }
  if (young) reset();
}

void Tracker::reset() {
  mapper_.drain();
  const std::lock_guard lock(map_.mutex);
  map_.clear();
  trajectory_.clear();
  initializer_.reset();
  state_ = TrackingState::Initializing;
  has_velocity_ = false;
  reference_ = kNone;
}

void Tracker::finishTracked() {
  current_.tracked = true;
  has_velocity_ = last_.tracked;
  if (has_velocity_) velocity_ = current_.T_camera_world * last_.T_camera_world.inverse();
  {
    const std::lock_guard lock(map_.mutex);
    const Keyframe& r = map_.keyframe(reference_);
    if (!r.alive) {
      local_map_.collect(map_, current_.points);
      reference_ = local_map_.reference();
    }
    if (reference_ != kNone)
      trajectory_.add(current_.frame, current_.timestamp_s, reference_,
                      current_.T_camera_world * map_.keyframe(reference_).T_camera_world.inverse());
  }
  if (needsKeyframe()) makeKeyframe();
}

bool Tracker::needsKeyframe() const {
  if (!mapper_.idle()) return false;
  int reference_points = 0;
  {
    const std::lock_guard lock(map_.mutex);
    const int min_observations = map_.keyframeCount() <= 2 ? 2 : 3;
    for (const PointId p : map_.keyframe(reference_).points)
      reference_points += p != kNone && map_.point(p).observation_count >= min_observations;
  }
  return inliers_ > 15 && inliers_ < settings_.tracker.keyframe_ratio * reference_points;
}

void Tracker::makeKeyframe() {
  if (mapper_.submit(current_.features, std::span(current_.points).first(current_.features.size()),
                     current_.T_camera_world, current_.frame, current_.timestamp_s))
    last_keyframe_s_ = current_.timestamp_s;
}

float Tracker::confidence() const {
  // Inliers that crowd into a corner say little about the rest of the picture: count the cells of a 4 x 4 grid that
  // hold some, of those that hold features at all.
  constexpr int kCells = 4;
  std::array<int, kCells * kCells> features{}, inliers{};
  for (int f = 0; f < current_.features.size(); ++f) {
    const Keypoint& k = current_.features.keypoints[f];
    const int cell = std::clamp(static_cast<int>(k.y * kCells / camera_.height), 0, kCells - 1) * kCells +
                     std::clamp(static_cast<int>(k.x * kCells / camera_.width), 0, kCells - 1);
    ++features[cell];
    inliers[cell] += current_.points[f].id != kNone;
  }
  int textured = 0, covered = 0;
  for (int c = 0; c < kCells * kCells; ++c) {
    textured += features[c] >= 5;
    covered += features[c] >= 5 && inliers[c] >= 2;
  }
  const float spread = textured == 0 ? 0.f : static_cast<float>(covered) / static_cast<float>(textured);
  const float enough = std::min(1.f, static_cast<float>(inliers_) / (3.f * static_cast<float>(settings_.tracker.min_inliers)));
  return spread * enough;
}

PoseEstimate Tracker::report() const {
  PoseEstimate e;
  e.frame = current_.frame;
  e.timestamp_s = current_.timestamp_s;
  e.state = state_;
  e.map_id = map_.id();
  if (state_ != TrackingState::Tracking) return e;
  e.T_camera_world = current_.T_camera_world;
  e.inliers = inliers_;
  e.confidence = confidence();
  return e;
}

}  // namespace depthscope::slam
