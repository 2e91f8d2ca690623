#include "slam/map_merger.hpp"

#include <mutex>

namespace depthscope::slam {

void MapMerger::merge(const PlaceLink& link, std::span<const PointPair> pairs,
                      std::span<const KeyframeId> window, std::span<const KeyframeId> around_now) {
  {
    const std::scoped_lock lock(map_.world_mutex, map_.mutex);
    const std::uint32_t now = map_.keyframe(link.now).map_id;
    const std::uint32_t before = map_.keyframe(link.before).map_id;
    if (before < now)
      map_.join(now, before, link.T_before_now);
    else
      map_.join(before, now, link.T_before_now.inverse());
  }
  fuse(link, pairs, window, around_now);
}

void MapMerger::fuse(const PlaceLink& link, std::span<const PointPair> pairs,
                     std::span<const KeyframeId> window, std::span<const KeyframeId> around_now) {
  {
    const std::lock_guard lock(map_.mutex);
    for (const PointPair& pair : pairs)
      if (map_.point(pair.before).alive && map_.point(pair.now).alive)
        map_.mergePoints(pair.now, pair.before);
  }
  fuser_.fuse(link.now, window);
  for (const KeyframeId k : around_now) fuser_.fuse(k, window);
}

}  // namespace depthscope::slam
