#include "slam/global_bundle.hpp"

#include <algorithm>
#include <mutex>

#include "slam/map_observation.hpp"

namespace depthscope::slam {

namespace {
constexpr int kQuotaStep = 25;  // points of a keyframe, added round by round while there is room
}  // namespace

GlobalBundle::GlobalBundle(const SlamSettings& settings, Map& map, BundleAdjuster& adjuster)
    : map_(map), adjuster_(adjuster), max_quota_(settings.extractor.capacity()) {
  const std::size_t keyframes = settings.capacity.keyframes;
  keyframes_.reserve(keyframes);
  pose_index_.resize(keyframes);
  points_.reserve(settings.capacity.map_points);
  point_index_.resize(settings.capacity.map_points);
  ranked_.reserve(settings.extractor.capacity());
  twists_.resize(keyframes);
  T_new_old_.resize(keyframes);
  growth_.reserve(settings.extractor.capacity());
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
  std::fill(point_index_.begin(), point_index_.end(), -1);
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
    if (point_index_[p] >= 0)
      ++have;
    else
      ranked_.push_back(p);
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
  point_index_[p] = index;
  points_.push_back(p);
  const float trust = map_.trustOf(p);
  for (const Observation& o : observations) {
    const int pose = pose_index_[o.keyframe];
    const Keyframe& view = map_.keyframe(o.keyframe);
    const Eigen::Vector3d& position = map_.point(p).position;
    BaObservation added =
        mapObservation(map_.shutter(), view, o.feature, twists_[pose], position, trust);
    added.pose = pose;
    added.point = index;
    added.shift = map_.shutter()
                      .motionInReadout(view.features.keypoints[o.feature].y, twists_[pose],
                                       view.T_camera_world * position)
                      .cast<float>();
    adjuster_.addObservation(added);
  }
  return true;
}

/// How the world moves around each keyframe: with it, and in scale as the depths of its points do.
void GlobalBundle::findMotions() {
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    Sim3 T_new_camera(adjuster_.poses()[i].T_camera_world.inverse());
    T_new_camera.s = medianGrowth(i);
    T_new_old_[i] = T_new_camera * Sim3(map_.keyframe(keyframes_[i]).T_camera_world);
  }
}

/// By what factor most depths of a keyframe's points grow. The median, for one point that goes off
/// to infinity would outweigh all others in a mean: on an instrument that moves there are such, and
/// once they took 16 frames of a sweep off by 50 to 200 mm.
double GlobalBundle::medianGrowth(std::size_t pose) {
  const Keyframe& k = map_.keyframe(keyframes_[pose]);
  const Pose& T_new = adjuster_.poses()[pose].T_camera_world;
  growth_.clear();
  for (const PointId p : k.points) {
    if (p == kNone || point_index_[p] < 0) continue;
    const double before = (k.T_camera_world * map_.point(p).position).z();
    const double now = (T_new * adjuster_.points()[point_index_[p]]).z();
    if (before > kMinDepth && now > kMinDepth) growth_.push_back(now / before);
  }
  if (growth_.empty()) return 1;
  const auto middle = growth_.begin() + static_cast<std::ptrdiff_t>(growth_.size() / 2);
  std::nth_element(growth_.begin(), middle, growth_.end());
  return *middle;
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
    if (map_.point(p).alive && map_.point(p).map_id == map_id && point_index_[p] < 0)
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
