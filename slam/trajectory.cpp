#include "slam/trajectory.hpp"

#include <algorithm>

namespace depthscope::slam {

void Trajectory::add(const AnchoredPose& pose) {
  if (ring_.empty()) return;
  ring_[next_] = pose;
  next_ = (next_ + 1) % ring_.size();
  count_ = std::min(count_ + 1, ring_.size());
}

std::uint32_t Trajectory::mainMap(const Map& map) const {
  std::uint32_t main = map.activeId();
  std::ptrdiff_t most = 1;
  for (std::uint32_t id = 1; id <= map.lastId(); ++id) {
    const auto frames =
        std::count_if(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(count_),
                      [&](const AnchoredPose& p) { return p.inMap(map, id); });
    if (frames < most) continue;
    most = frames;
    main = id;
  }
  return main;
}

std::vector<StampedPose> Trajectory::corrected(const Map& map, std::uint32_t map_id) const {
  return corrected(map, map_id,
                   [&](KeyframeId k, double) { return map.keyframe(k).T_camera_world; });
}

std::vector<StampedPose> Trajectory::corrected(const Map& map, std::uint32_t map_id,
                                               const PoseOfKeyframe& T_keyframe_world) const {
  std::vector<StampedPose> poses;
  poses.reserve(count_);
  const std::size_t oldest = count_ == ring_.size() ? next_ : 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const AnchoredPose& p = ring_[(oldest + i) % ring_.size()];
    if (!p.inMap(map, map_id)) continue;
    const Pose T_camera_world =
        p.T_camera_reference(map) * T_keyframe_world(p.reference, p.timestamp_s);
    poses.push_back({p.frame, p.timestamp_s, T_camera_world.inverse()});
  }
  return poses;
}

}  // namespace depthscope::slam
