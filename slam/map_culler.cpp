#include "slam/map_culler.hpp"

#include <algorithm>
#include <mutex>

namespace depthscope::slam {

namespace {
constexpr double kMinFoundShare = 0.25;  // of the frames in which a point was predicted visible
constexpr int kMinObservations = 3;      // after two more keyframes
constexpr int kMinKeyframes = 3;         // a map is not culled below
constexpr int kOtherObservers = 3;       // that make an observation redundant
// What age and distance weigh against the share of points that only a keyframe sees: they decide
// between keyframes that are about as redundant. Old tissue may have changed since; what is far
// from the scope is needed later, if ever.
constexpr double kAgeWeight = 0.1, kDistanceWeight = 0.1;
}  // namespace

MapCuller::MapCuller(const SlamSettings& settings, Map& map, FrameRecords& records)
    : settings_(settings.mapper),
      // For what two new keyframes may add, where the capacity allows of so much.
      points_needed_(std::min(2 * settings.extractor.features, settings.capacity.map_points / 4)),
      map_(map),
      records_(records) {
  votes_.resize(settings.capacity.keyframes);
}

void MapCuller::cullRecentPoints(std::vector<PointRef>& recent, std::int64_t current_serial) {
  const std::lock_guard lock(map_.mutex);
  std::size_t kept = 0;
  for (const PointRef& ref : recent) {
    if (map_.resolve(ref) != ref.id) continue;  // gone, or merged into an older point
    const MapPoint& p = map_.point(ref.id);
    const std::int64_t age = current_serial - p.born_serial;
    if (p.visible > 0 && p.found < kMinFoundShare * p.visible) {
      map_.removePoint(ref.id);
    } else if (age >= 2 && p.observation_count < kMinObservations) {
      map_.removePoint(ref.id);
    } else if (age < 3) {
      recent[kept++] = ref;
    }
  }
  recent.resize(kept);
}

double MapCuller::redundancy(KeyframeId id) const {
  const Keyframe& k = map_.keyframe(id);
  int points = 0, redundant = 0;
  for (int f = 0; f < k.features.size(); ++f) {
    const PointId p = k.points[f];
    if (p == kNone) continue;
    ++points;
    if (map_.point(p).observation_count <= kOtherObservers) continue;
    const int octave = k.features.keypoints[f].octave;
    int others = 0;
    for (const Observation& o : map_.observations(p)) {
      if (o.keyframe == id) continue;
      others += map_.keyframe(o.keyframe).features.keypoints[o.feature].octave <= octave + 1;
    }
    redundant += others >= kOtherObservers;
  }
  return points == 0 ? 1 : static_cast<double>(redundant) / points;
}

void MapCuller::cullKeyframes(std::span<const KeyframeId> candidates) {
  for (const KeyframeId k : candidates) {
    const std::lock_guard lock(map_.mutex);
    if (map_.keyframe(k).alive && map_.keyframeCount() > kMinKeyframes &&
        redundancy(k) > settings_.redundancy)
      remove(k);
  }
}

/// How little would be lost with a keyframe, 0..1.2: its redundancy, its age in keyframes over
/// their number, and its distance from `newest` against the depth that one sees (another map is
/// far).
double MapCuller::dispensability(KeyframeId id, KeyframeId newest) {
  const Keyframe& k = map_.keyframe(id);
  const Keyframe& n = map_.keyframe(newest);
  const double age = std::min(
      1.0, static_cast<double>(n.serial - k.serial) / static_cast<double>(map_.keyframeCapacity()));
  const double depth = map_.medianDepth(newest);
  const double apart = (k.T_camera_world.inverse().t - n.T_camera_world.inverse().t).norm();
  const double distance = k.map_id != n.map_id || !(depth > 0) ? 1 : apart / (apart + depth);
  return redundancy(id) + kAgeWeight * age + kDistanceWeight * distance;
}

KeyframeId MapCuller::newest() const {
  KeyframeId newest = kNone;
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (map_.keyframe(k).alive &&
        (newest == kNone || map_.keyframe(k).serial > map_.keyframe(newest).serial))
      newest = k;
  return newest;
}

KeyframeId MapCuller::leastUseful() {
  const KeyframeId last = newest();
  KeyframeId least = kNone;
  double most = -1;
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k) {
    if (!map_.keyframe(k).alive || k == last) continue;
    const double d = dispensability(k, last);
    if (d < most || (d == most && map_.keyframe(k).serial > map_.keyframe(least).serial)) continue;
    most = d;
    least = k;
  }
  return least;
}

void MapCuller::makeRoom(int slots) {
  const std::lock_guard lock(map_.mutex);
  const auto crowded = [&] {
    return map_.freeKeyframes() < slots ||
           map_.pointCapacity() - map_.pointCount() < points_needed_;
  };
  while (map_.keyframeCount() > kMinKeyframes && crowded()) remove(leastUseful());
}

void MapCuller::remove(KeyframeId id) {
  const KeyframeId heir = heirOf(id);
  if (heir == kNone)
    records_.drop(id);
  else
    records_.rebase(map_, id, heir);
  map_.removeKeyframe(id);
}

KeyframeId MapCuller::heirOf(KeyframeId id) {
  map_.countShared(id, votes_);
  const auto best = std::max_element(votes_.begin(), votes_.end());
  if (*best > 0) return static_cast<KeyframeId>(best - votes_.begin());
  // It sees nothing that others see: the keyframe of its map nearest in time, if there is one.
  const Keyframe& k = map_.keyframe(id);
  const auto gap = [&](KeyframeId other) {
    return std::abs(map_.keyframe(other).serial - k.serial);
  };
  KeyframeId heir = kNone;
  for (KeyframeId other = 0; other < map_.keyframeCapacity(); ++other) {
    const Keyframe& o = map_.keyframe(other);
    if (!o.alive || other == id || o.map_id != k.map_id) continue;
    if (heir == kNone || gap(other) < gap(heir)) heir = other;
  }
  return heir;
}

}  // namespace depthscope::slam
