#pragma once
#include "slam/trajectory.hpp"
#include "slam/view_keeper.hpp"

namespace depthscope::slam {

/// All that hangs on keyframes and outlives them. Guarded by the map's mutex.
struct FrameRecords {
  Trajectory trajectory;
  ViewKeeper views;

  /// What hangs on keyframe `from` hangs on `to` afterwards; call before `from` is removed.
  void rebase(const Map& map, KeyframeId from, KeyframeId to) {
    slam::rebase(trajectory.poses(), map, from, to);
    slam::rebase(views.poses(), map, from, to);
  }
  /// Forgets what hangs on a keyframe.
  void drop(KeyframeId keyframe) {
    slam::drop(trajectory.poses(), keyframe);
    slam::drop(views.poses(), keyframe);
  }
  /// Forgets a connected map.
  void dropMap(const Map& map, std::uint32_t map_id) {
    for (KeyframeId k = 0; k < map.keyframeCapacity(); ++k)
      if (map.keyframe(k).alive && map.keyframe(k).map_id == map_id) drop(k);
  }
  void clear() {
    trajectory.clear();
    views.clear();
  }
};

}  // namespace depthscope::slam
