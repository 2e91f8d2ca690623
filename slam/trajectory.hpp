#pragma once
#include <functional>
#include <vector>

#include "slam/anchored_pose.hpp"
#include "slam/slam_system.hpp"

namespace depthscope::slam {

/// Poses of the last tracked frames. A ring of fixed capacity. Guarded by the map's mutex.
class Trajectory {
 public:
  explicit Trajectory(std::int64_t capacity) { ring_.resize(static_cast<std::size_t>(capacity)); }

  void add(const AnchoredPose& pose);
  void clear() { count_ = next_ = 0; }
  /// All that is kept, in no order.
  std::span<AnchoredPose> poses() { return std::span(ring_).first(count_); }
  /// The connected map that most frames were tracked in; the newer one of equals.
  std::uint32_t mainMap(const Map& map) const;
  /// Poses of the frames tracked in one connected map, in order of time.
  std::vector<StampedPose> corrected(const Map& map, std::uint32_t map_id) const;
  /// The same where T_camera_world of the keyframe that a frame hangs on was another at its time.
  using PoseOfKeyframe = std::function<Pose(KeyframeId, double timestamp_s)>;
  std::vector<StampedPose> corrected(const Map& map, std::uint32_t map_id,
                                     const PoseOfKeyframe& T_keyframe_world) const;

 private:
  std::vector<AnchoredPose> ring_;
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace depthscope::slam
