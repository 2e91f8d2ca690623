#include "slam/local_map.hpp"

#include <algorithm>

namespace depthscope::slam {

LocalPoint makeLocalPoint(const Map& map, PointId id) {
  const MapPoint& p = map.point(id);
  return {map.ref(id),    p.position,   p.normal.cast<float>(), p.min_distance,
          p.max_distance, p.descriptor, p.poseWeight(),         false};
}

LocalMap::LocalMap(const SlamSettings& settings)
    : max_keyframes_(settings.tracker.local_keyframes) {
  points_.reserve(settings.capacity.local_points);
  votes_.resize(settings.capacity.keyframes);
  neighbour_votes_.resize(settings.capacity.keyframes);
  chosen_.reserve(settings.capacity.keyframes);
  point_stamp_.resize(settings.capacity.map_points, 0);
  tracked_stamp_.resize(settings.capacity.map_points, 0);
  keyframe_stamp_.resize(settings.capacity.keyframes, 0);
}

void LocalMap::addKeyframe(KeyframeId id) {
  if (keyframe_stamp_[id] == stamp_ || static_cast<int>(chosen_.size()) >= max_keyframes_) return;
  keyframe_stamp_[id] = stamp_;
  chosen_.push_back(id);
}

void LocalMap::collect(const Map& map, std::span<const PointRef> tracked) {
  ++stamp_;
  points_.clear();
  chosen_.clear();
  std::fill(votes_.begin(), votes_.end(), 0);
  for (const PointRef& ref : tracked) {
    const PointId id = map.resolve(ref);
    if (id == kNone) continue;
    tracked_stamp_[id] = stamp_;
    for (const Observation& o : map.observations(id)) ++votes_[o.keyframe];
  }
  // Most votes first; equal votes: the newer keyframe.
  const auto better = [&](KeyframeId a, KeyframeId b) {
    return votes_[a] != votes_[b] ? votes_[a] > votes_[b]
                                  : map.keyframe(a).serial > map.keyframe(b).serial;
  };
  for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k)
    if (votes_[k] > 0) chosen_.push_back(k);
  std::sort(chosen_.begin(), chosen_.end(), better);
  reference_ = chosen_.empty() ? kNone : chosen_.front();
  chosen_.resize(std::min<std::size_t>(chosen_.size(), max_keyframes_));
  for (const KeyframeId k : chosen_) keyframe_stamp_[k] = stamp_;

  // Neighbours of the best few: they hold what is about to come into view.
  const std::size_t seeds = std::min<std::size_t>(chosen_.size(), 5);
  for (std::size_t i = 0; i < seeds; ++i) {
    map.countShared(chosen_[i], neighbour_votes_);
    for (int n = 0; n < 3; ++n) {
      const auto best = std::max_element(neighbour_votes_.begin(), neighbour_votes_.end());
      if (*best < 15) break;
      addKeyframe(static_cast<KeyframeId>(best - neighbour_votes_.begin()));
      *best = 0;
    }
  }

  for (const KeyframeId k : chosen_) {
    for (const PointId id : map.keyframe(k).points) {
      if (id == kNone || point_stamp_[id] == stamp_) continue;
      if (points_.size() == points_.capacity()) return;
      point_stamp_[id] = stamp_;
      points_.push_back(makeLocalPoint(map, id));
      points_.back().tracked = tracked_stamp_[id] == stamp_;
    }
  }
}

}  // namespace depthscope::slam
