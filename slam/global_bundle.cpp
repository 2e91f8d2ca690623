#include "slam/global_bundle.hpp"

#include <algorithm>
#include <mutex>

namespace depthscope::slam {

namespace {
constexpr int kQuotaStep = 25;  // points of a keyframe, added round by round while there is room
}  // namespace

GlobalBundle::GlobalBundle(const SlamSettings& settings, Map& map, BundleAdjuster& adjuster)
    : map_(map), adjuster_(adjuster), max_quota_(settings.extractor.features) {
  const std::size_t keyframes = settings.capacity.keyframes;
  keyframes_.reserve(keyframes);
  pose_index_.resize(keyframes);
  points_.reserve(settings.capacity.map_points);
  chosen_.resize(settings.capacity.map_points);
  ranked_.reserve(settings.extractor.features);
  twists_.resize(keyframes);
  T_new_old_.resize(keyframes);
  depth_old_.resize(keyframes);
  depth_new_.resize(keyframes);
}

BaSummary GlobalBundle::adjust(std::uint32_t map_id, int iterations,
                               const std::atomic<bool>* stop) {
  gather(map_id);
  BaSettings settings;
  settings.max_iterations = iterations;
  const BaSummary summary = adjuster_.solve(map_.intrinsics(), settings, stop);
  if (summary.end == BaSummary::End::Failed || summary.iterations == 0) return summary;
  if (summary.end != BaSummary::End::Stopped) correctShutter();
  keepScale();
  writeBack(map_id, summary.end != BaSummary::End::Stopped);
  return summary;
}

void GlobalBundle::estimateReadout(std::uint32_t map_id) {
  gather(map_id);
  correctShutter();
}

void GlobalBundle::correctShutter() {
  if (const auto readout = adjuster_.estimateShared(map_.intrinsics()))
    map_.shutter().correct(readout->offset, readout->sigma);
}

void GlobalBundle::gather(std::uint32_t map_id) {
  adjuster_.clear();
  keyframes_.clear();
  points_.clear();
  std::fill(chosen_.begin(), chosen_.end(), 0);
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k) {
    if (!map_.keyframe(k).alive || map_.keyframe(k).map_id != map_id) continue;
    pose_index_[k] = adjuster_.addPose(map_.keyframe(k).T_camera_world, false);
    twists_[keyframes_.size()] = map_.twistOf(k);
    keyframes_.push_back(k);
  }
  fixOldest();
  choosePoints();
}

/// One keyframe holds the map in its place. Two would hold its scale as well, but also, for ever,
/// the relative pose that the two oldest got when it was known worst.
void GlobalBundle::fixOldest() {
  const auto oldest =
      std::min_element(keyframes_.begin(), keyframes_.end(), [&](KeyframeId a, KeyframeId b) {
        return map_.keyframe(a).serial < map_.keyframe(b).serial;
      });
  oldest_ = static_cast<int>(oldest - keyframes_.begin());
  if (oldest != keyframes_.end()) adjuster_.poses()[static_cast<std::size_t>(oldest_)].fixed = true;
}

/// Nothing in the pictures tells the scale: the keyframes stay as far from the oldest, in the mean,
/// as they were.
void GlobalBundle::keepScale() {
  const auto poses = adjuster_.poses();
  const Eigen::Vector3d centre =
      poses[static_cast<std::size_t>(oldest_)].T_camera_world.inverse().t;
  double before = 0, now = 0;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    before += (map_.keyframe(keyframes_[i]).T_camera_world.inverse().t - centre).norm();
    now += (poses[i].T_camera_world.inverse().t - centre).norm();
  }
  if (!(before > 0 && now > 0)) return;
  const double scale = before / now;
  const auto scaled = [&](const Eigen::Vector3d& p) { return centre + scale * (p - centre); };
  for (BaPose& pose : poses)
    pose.T_camera_world.t = -(pose.T_camera_world.R * scaled(pose.T_camera_world.inverse().t));
  for (Eigen::Vector3d& point : adjuster_.points()) point = scaled(point);
}

void GlobalBundle::choosePoints() {
  for (int quota = kQuotaStep; quota < max_quota_ + kQuotaStep; quota += kQuotaStep)
    for (const KeyframeId k : keyframes_)
      if (!choosePointsOf(k, quota)) return;
}

/// Until `quota` points of a keyframe are in the problem; false when that is full.
bool GlobalBundle::choosePointsOf(KeyframeId keyframe, int quota) {
  int have = 0;
  ranked_.clear();
  for (const PointId p : map_.keyframe(keyframe).points) {
    if (p == kNone) continue;
    have += chosen_[p];
    if (!chosen_[p]) ranked_.push_back(p);
  }
  std::sort(ranked_.begin(), ranked_.end(), [&](PointId a, PointId b) {
    const int na = map_.point(a).observation_count, nb = map_.point(b).observation_count;
    return na != nb ? na > nb : a < b;
  });
  for (const PointId p : ranked_) {
    if (have >= quota) break;
    if (!choose(p)) return false;
    ++have;
  }
  return true;
}

bool GlobalBundle::choose(PointId p) {
  const auto observations = map_.observations(p);
  if (adjuster_.freeObservations() < static_cast<int>(observations.size())) return false;
  const int index = adjuster_.addPoint(map_.point(p).position);
  if (index < 0) return false;
  chosen_[p] = 1;
  points_.push_back(p);
  const float trust = map_.trustOf(p);
  for (const Observation& o : observations) {
    const int pose = pose_index_[o.keyframe];
    const Keyframe& view = map_.keyframe(o.keyframe);
    const Keypoint& k = view.features.keypoints[o.feature];
    const Eigen::Vector3d p_camera = view.T_camera_world * map_.point(p).position;
    const RollingShutter& shutter = map_.shutter();
    BaObservation added;
    added.pose = pose;
    added.point = index;
    added.pixel = shutter.atMiddleRow(k, twists_[pose], p_camera).cast<float>();
    added.inv_sigma2 = trust / (k.sigma * k.sigma);
    added.shift = shutter.motionInReadout(k.y, twists_[pose], p_camera).cast<float>();
    adjuster_.addObservation(added);
  }
  return true;
}

/// How the world moves around each keyframe: with it, and in scale as the depths of its points do.
void GlobalBundle::findMotions() {
  std::fill(depth_old_.begin(), depth_old_.end(), 0);
  std::fill(depth_new_.begin(), depth_new_.end(), 0);
  for (const BaObservation& o : adjuster_.observations()) {
    if (!o.inlier) continue;
    const Pose& T_old = map_.keyframe(keyframes_[o.pose]).T_camera_world;
    depth_old_[o.pose] += (T_old * map_.point(points_[o.point]).position).z();
    depth_new_[o.pose] +=
        (adjuster_.poses()[o.pose].T_camera_world * adjuster_.points()[o.point]).z();
  }
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    Sim3 T_new_camera(adjuster_.poses()[i].T_camera_world.inverse());
    const bool scaled = depth_old_[i] > 0 && depth_new_[i] > 0;
    T_new_camera.s = scaled ? depth_new_[i] / depth_old_[i] : 1;
    T_new_old_[i] = T_new_camera * Sim3(map_.keyframe(keyframes_[i]).T_camera_world);
  }
}

/// The pose of the keyframe by which the tracker is told how the world around it moved.
int GlobalBundle::newest() const {
  return pose_index_[*std::max_element(keyframes_.begin(), keyframes_.end(),
                                       [&](KeyframeId a, KeyframeId b) {
                                         return map_.keyframe(a).serial < map_.keyframe(b).serial;
                                       })];
}

void GlobalBundle::writeBack(std::uint32_t map_id, bool remove_outliers) {
  findMotions();
  const std::scoped_lock lock(map_.world_mutex, map_.mutex);
  for (PointId p = 0; p < map_.pointEnd(); ++p)
    if (map_.point(p).alive && map_.point(p).map_id == map_id && !chosen_[p])
      map_.movePoint(p, T_new_old_[pose_index_[map_.observations(p).front().keyframe]]);
  for (std::size_t i = 0; i < points_.size(); ++i)
    map_.point(points_[i]).position = adjuster_.points()[i];
  for (std::size_t i = 0; i < keyframes_.size(); ++i)
    map_.moveKeyframe(keyframes_[i], T_new_old_[i]);
  if (remove_outliers)
    for (const BaObservation& o : adjuster_.observations())
      if (!o.inlier && map_.point(points_[o.point]).alive)
        map_.unobserve(points_[o.point], keyframes_[o.pose]);
  for (PointId p = 0; p < map_.pointEnd(); ++p)
    if (map_.point(p).alive && map_.point(p).map_id == map_id) map_.refreshGeometry(p);
  if (map_id == map_.activeId()) map_.correctWorld(T_new_old_[newest()]);
}

}  // namespace depthscope::slam
