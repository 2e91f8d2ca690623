#include "slam/view_keeper.hpp"

#include <limits>
#include <utility>

namespace depthscope::slam {

bool ViewKeeper::offer(const Map& map, const AnchoredPose& frame, double depth, bool keyframe) {
  if (views_.empty() || !(depth > 0)) return false;
  if (!keyframe) {
    const std::uint32_t map_id = map.keyframe(frame.reference).map_id;
    const Pose T_camera_world = frame.T_camera_world(map);
    for (const AnchoredPose& view : std::as_const(*this).poses())
      if (view.inMap(map, map_id) &&
          motionBetween(T_camera_world, view.T_camera_world(map), depth) < min_motion_)
        return false;
  }
  std::size_t slot = count_;
  if (count_ == views_.size())
    slot = mostRedundant(map, depth);
  else
    ++count_;
  views_[slot] = frame;
  return true;
}

void ViewKeeper::becameKeyframe(const Map& map, std::int64_t frame, KeyframeId keyframe) {
  for (AnchoredPose& view : poses())
    if (view.frame == frame) view.anchor(map, keyframe, Pose{});
}

/// Forgotten ones come first.
std::size_t ViewKeeper::mostRedundant(const Map& map, double depth) const {
  std::size_t most = 0;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < count_; ++i) {
    if (views_[i].reference == kNone) return i;
    const std::uint32_t map_id = map.keyframe(views_[i].reference).map_id;
    const Pose T_i_world = views_[i].T_camera_world(map);
    for (std::size_t j = 0; j < count_; ++j) {
      if (j == i || !views_[j].inMap(map, map_id)) continue;
      const double motion = motionBetween(T_i_world, views_[j].T_camera_world(map), depth);
      if (motion >= least) continue;
      least = motion;
      most = i;
    }
  }
  return most;
}

}  // namespace depthscope::slam
