#include "slam/loop_closer.hpp"

#include <mutex>

namespace depthscope::slam {

namespace {
/// Bundle adjustment holds two keyframes that see the same points together to about a pixel, a few
/// thousandths of a radian. A loop that bends such a tie by more than ten times that is wrong.
constexpr double kMaxBent = 0.05;
}  // namespace

bool LoopCloser::close(const PlaceLink& link, std::span<const PointPair> pairs,
                       std::span<const KeyframeId> window, std::span<const KeyframeId> around_now) {
  if (graph_.optimize(link).bent > kMaxBent) return false;
  moveMap(link);
  merger_.fuse(link, pairs, window, around_now);
  graph_.remember(link);
  return true;
}

void LoopCloser::moveMap(const PlaceLink& link) {
  const std::uint32_t id = map_.keyframe(link.now).map_id;
  const std::scoped_lock lock(map_.world_mutex, map_.mutex);
  for (PointId p = 0; p < map_.pointEnd(); ++p)
    if (map_.point(p).alive && map_.point(p).map_id == id)
      map_.movePoint(p, graph_.T_new_old(map_.observations(p).front().keyframe));
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
    if (map_.keyframe(k).alive && map_.keyframe(k).map_id == id)
      map_.moveKeyframe(k, graph_.T_new_old(k));
  if (id == map_.activeId()) map_.correctWorld(graph_.T_new_old(link.now));
}

}  // namespace depthscope::slam
