#pragma once
#include <cstdint>

#include "types/pose.hpp"

namespace depthscope {

enum class TrackingState : std::uint8_t {
  Initializing,  // no map yet: two views with enough parallax are being looked for
  Tracking,      // the pose is known
  Lost,          // there is a map, but the last frame was not found in it
};

/// What the tracker knows after one frame. `T_camera_world` has a meaning only while Tracking.
struct PoseEstimate {
  std::int64_t frame = -1;  // sequence number of the frame it belongs to
  double timestamp_s = 0;   // capture time of that frame, in the source's clock
  TrackingState state = TrackingState::Initializing;
  Pose T_camera_world;
  float confidence = 0;      // 0..1 from inliers and their spread; 0 unless Tracking
  std::uint32_t map_id = 0;  // changes when a new map (a new world frame) is started
  std::int32_t inliers = 0;  // map points that agree with the pose
};

}  // namespace depthscope
