#include "slam/map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace depthscope::slam {

namespace {
constexpr int kMaxObservations = 64;  // upper limit of the setting, for scratch on the stack
}

Map::Map(const SlamSettings& settings, const CameraModel& camera)
    : intrinsics_{camera.fx, camera.fy, camera.cx, camera.cy},
      shutter_(camera),
      keyframes_(settings.capacity.keyframes),
      points_(settings.capacity.map_points),
      observations_per_point_(std::min(settings.capacity.observations_per_point, kMaxObservations)),
      log_scale_factor_(std::log(settings.extractor.scale_factor)) {
  const int features = settings.extractor.capacity();
  for (Keyframe& k : keyframes_) {
    k.features = FeatureSet(features, camera);
    k.points.reserve(features);
  }
  // The picture in which a map begins takes longest anyhow.
  for (Keyframe& k : std::span(keyframes_).first(std::min<std::size_t>(2, keyframes_.size())))
    k.features.touch();
  observations_.resize(points_.size() * observations_per_point_);
  scales_.resize(settings.extractor.levels);
  for (std::size_t i = 0; i < scales_.size(); ++i)
    scales_[i] =
        static_cast<float>(std::pow(settings.extractor.scale_factor, static_cast<double>(i)));
  depth_scratch_.reserve(features);
  free_keyframes_.reserve(keyframes_.size());
  free_points_.reserve(points_.size());
  clear();
}

void Map::clear() {
  for (Keyframe& k : keyframes_) k.alive = false;
  for (MapPoint& p : points_) {
    if (p.alive) ++p.generation;
    p.alive = false;
    p.replaced_by = {};
  }
  // Slots are handed out from the back: lowest index first.
  free_keyframes_.clear();
  for (int i = keyframeCapacity() - 1; i >= 0; --i) free_keyframes_.push_back(i);
  free_points_.clear();
  for (int i = pointCapacity() - 1; i >= 0; --i) free_points_.push_back(i);
  keyframe_count_ = point_count_ = point_end_ = 0;
}

void Map::removeMap(std::uint32_t map_id) {
  for (KeyframeId k = 0; k < keyframeCapacity(); ++k)
    if (keyframes_[k].alive && keyframes_[k].map_id == map_id) removeKeyframe(k);
}

int Map::keyframesOf(std::uint32_t map_id) const {
  return static_cast<int>(
      std::count_if(keyframes_.begin(), keyframes_.end(),
                    [&](const Keyframe& k) { return k.alive && k.map_id == map_id; }));
}

KeyframeId Map::addKeyframe(const FeatureSet& features, const Pose& T_camera_world,
                            std::int64_t frame, double timestamp_s) {
  if (free_keyframes_.empty()) return kNone;
  const KeyframeId id = free_keyframes_.back();
  free_keyframes_.pop_back();
  Keyframe& k = keyframes_[id];
  k.alive = true;
  k.map_id = active_id_;
  k.serial = next_serial_++;
  k.frame = frame;
  k.timestamp_s = timestamp_s;
  k.T_camera_world = T_camera_world;
  k.twist = {};
  k.unit = 1;
  k.features = features;  // equal capacities: copied without allocating
  k.points.assign(features.size(), kNone);
  ++keyframe_count_;
  return id;
}

PointId Map::addPoint(const Eigen::Vector3d& position, std::int64_t born_serial) {
  if (free_points_.empty()) return kNone;
  const PointId id = free_points_.back();
  free_points_.pop_back();
  MapPoint& p = points_[id];
  const std::uint32_t generation = p.generation;
  p = MapPoint{};
  p.generation = generation;
  p.alive = true;
  p.map_id = active_id_;
  p.position = position;
  p.born_serial = born_serial;
  ++point_count_;
  point_end_ = std::max(point_end_, id + 1);
  return id;
}

std::span<const Observation> Map::observations(PointId id) const {
  return {observations_.data() + static_cast<std::size_t>(id) * observations_per_point_,
          static_cast<std::size_t>(points_[id].observation_count)};
}

bool Map::isObservedBy(PointId point, KeyframeId keyframe) const {
  for (const Observation& o : observations(point))
    if (o.keyframe == keyframe) return true;
  return false;
}

bool Map::observe(PointId point, KeyframeId keyframe, int feature) {
  MapPoint& p = points_[point];
  Keyframe& k = keyframes_[keyframe];
  if (p.observation_count == observations_per_point_ || k.points[feature] != kNone) return false;
  if (isObservedBy(point, keyframe)) return false;
  observations_[static_cast<std::size_t>(point) * observations_per_point_ + p.observation_count++] =
      {keyframe, feature};
  k.points[feature] = point;
  return true;
}

void Map::dropObservation(PointId point, KeyframeId keyframe) {
  MapPoint& p = points_[point];
  Observation* o = observations_.data() + static_cast<std::size_t>(point) * observations_per_point_;
  for (int i = 0; i < p.observation_count; ++i) {
    if (o[i].keyframe != keyframe) continue;
    keyframes_[keyframe].points[o[i].feature] = kNone;
    std::copy(o + i + 1, o + p.observation_count, o + i);  // keep the order of observation
    --p.observation_count;
    return;
  }
}

void Map::unobserve(PointId point, KeyframeId keyframe) {
  dropObservation(point, keyframe);
  if (points_[point].observation_count < 2) removePoint(point);
}

void Map::removePoint(PointId id) {
  MapPoint& p = points_[id];
  if (!p.alive) return;
  for (const Observation& o : observations(id)) keyframes_[o.keyframe].points[o.feature] = kNone;
  p.observation_count = 0;
  p.alive = false;
  p.replaced_by = {};
  ++p.generation;
  free_points_.push_back(id);
  --point_count_;
}

void Map::mergePoints(PointId from, PointId into) {
  if (from == into) return;
  std::array<Observation, kMaxObservations> moved;
  const auto old = observations(from);
  const std::size_t n = old.size();
  std::copy(old.begin(), old.end(), moved.begin());
  MapPoint& a = points_[from];
  MapPoint& b = points_[into];
  b.visible += a.visible;
  b.found += a.found;
  removePoint(from);
  a.replaced_by = ref(into);
  for (std::size_t i = 0; i < n; ++i) observe(into, moved[i].keyframe, moved[i].feature);
  refreshPoint(into);
}

PointId Map::resolve(PointRef ref) const {
  for (int hops = 0; ref.id != kNone && hops < 8; ++hops) {
    const MapPoint& p = points_[ref.id];
    if (p.alive) return p.generation == ref.generation ? ref.id : kNone;
    if (p.generation != ref.generation + 1) return kNone;  // the slot has had another life since
    ref = p.replaced_by;
  }
  return kNone;
}

void Map::removeKeyframe(KeyframeId id) {
  Keyframe& k = keyframes_[id];
  if (!k.alive) return;
  for (std::size_t i = 0; i < k.points.size(); ++i)
    if (const PointId p = k.points[i]; p != kNone) unobserve(p, id);
  k.alive = false;
  free_keyframes_.push_back(id);
  --keyframe_count_;
}

void Map::refreshPoint(PointId id) {
  MapPoint& p = points_[id];
  const auto obs = observations(id);
  if (obs.empty()) return;
  // The descriptor with the least median distance to the others (Mur-Artal et al. 2015, section
  // III.C).
  const auto descriptorOf = [&](const Observation& o) -> const Descriptor& {
    return keyframes_[o.keyframe].features.descriptors[o.feature];
  };
  int best_median = 1 << 30;
  std::array<int, kMaxObservations> d;
  for (std::size_t i = 0; i < obs.size(); ++i) {
    for (std::size_t j = 0; j < obs.size(); ++j)
      d[j] = hammingDistance(descriptorOf(obs[i]), descriptorOf(obs[j]));
    std::nth_element(d.begin(), d.begin() + obs.size() / 2, d.begin() + obs.size());
    if (d[obs.size() / 2] >= best_median) continue;
    best_median = d[obs.size() / 2];
    p.descriptor = descriptorOf(obs[i]);
  }
  refreshGeometry(id);
}

void Map::refreshGeometry(PointId id) {
  MapPoint& p = points_[id];
  const auto obs = observations(id);
  if (obs.empty()) return;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const Observation& o : obs)
    normal += (p.position - keyframes_[o.keyframe].T_camera_world.inverse().t).normalized();
  p.normal = normal.normalized();
  // Range from the first observation, the one that made the point.
  const Keyframe& k = keyframes_[obs.front().keyframe];
  const double distance = (k.T_camera_world * p.position).norm();
  const int octave = k.features.keypoints[obs.front().feature].octave;
  p.max_distance = static_cast<float>(distance * scales_[octave]);
  p.min_distance = p.max_distance / scales_.back();
}

int Map::predictLevel(double max_distance, double distance) const {
  const int level =
      static_cast<int>(std::ceil(std::log(max_distance / distance) / log_scale_factor_));
  return std::clamp(level, 0, levels() - 1);
}

void Map::countShared(KeyframeId id, std::span<int> votes) const {
  std::fill(votes.begin(), votes.end(), 0);
  for (const PointId p : keyframes_[id].points) {
    if (p == kNone) continue;
    for (const Observation& o : observations(p)) ++votes[o.keyframe];
  }
  votes[id] = 0;
}

double Map::medianDepth(KeyframeId id) {
  const Keyframe& k = keyframes_[id];
  depth_scratch_.clear();
  for (const PointId p : k.points)
    if (p != kNone) depth_scratch_.push_back((k.T_camera_world * points_[p].position).z());
  if (depth_scratch_.empty()) return 0;
  const auto middle = depth_scratch_.begin() + depth_scratch_.size() / 2;
  std::nth_element(depth_scratch_.begin(), middle, depth_scratch_.end());
  return *middle;
}

void Map::rescale(double factor) {
  for (Keyframe& k : keyframes_) {
    if (!k.alive || k.map_id != active_id_) continue;
    k.T_camera_world.t *= factor;
    k.twist.v *= factor;
  }
  for (MapPoint& p : points_) {
    if (!p.alive || p.map_id != active_id_) continue;
    p.position *= factor;
    p.min_distance *= static_cast<float>(factor);
    p.max_distance *= static_cast<float>(factor);
  }
}

void Map::moveKeyframe(KeyframeId id, const Sim3& T_new_old) {
  Keyframe& k = keyframes_[id];
  k.T_camera_world = T_new_old.moved(k.T_camera_world);
  k.twist.v *= T_new_old.s;
  k.unit *= T_new_old.s;
}

void Map::movePoint(PointId id, const Sim3& T_new_old) {
  MapPoint& p = points_[id];
  p.position = T_new_old * p.position;
  p.normal = T_new_old.R * p.normal;
  p.min_distance *= static_cast<float>(T_new_old.s);
  p.max_distance *= static_cast<float>(T_new_old.s);
}

void Map::join(std::uint32_t from, std::uint32_t into, const Sim3& T_into_from) {
  for (KeyframeId k = 0; k < keyframeCapacity(); ++k) {
    if (!keyframes_[k].alive || keyframes_[k].map_id != from) continue;
    moveKeyframe(k, T_into_from);
    keyframes_[k].map_id = into;
  }
  for (PointId p = 0; p < point_end_; ++p) {
    if (!points_[p].alive || points_[p].map_id != from) continue;
    movePoint(p, T_into_from);
    points_[p].map_id = into;
  }
  if (active_id_ != from) return;
  active_id_ = into;
  correctWorld(T_into_from);
}

int Map::mapCount() const {
  // The first keyframe, by slot, of each.
  int count = 0;
  for (auto k = keyframes_.begin(); k != keyframes_.end(); ++k)
    count += k->alive && std::none_of(keyframes_.begin(), k, [&](const Keyframe& other) {
               return other.alive && other.map_id == k->map_id;
             });
  return count;
}

std::size_t Map::keyframeBytes() const {
  std::size_t bytes = 0;
  for (const Keyframe& k : keyframes_)
    bytes += sizeof k + k.features.keypoints.capacity() *
                            (2 * sizeof(Keypoint) + sizeof(Descriptor) + sizeof(PointId));
  return bytes;
}

std::size_t Map::pointBytes() const {
  return points_.capacity() * sizeof(MapPoint) + observations_.capacity() * sizeof(Observation) +
         free_points_.capacity() * sizeof(PointId);
}

}  // namespace depthscope::slam
