#pragma once
#include <optional>
#include <string_view>

#include "platform/daemon/ar_link.hpp"
#include "platform/daemon/pose_wait.hpp"
#include "platform/map_scale.hpp"

namespace depthscope::platform {

/// Measures how long the unit of the tracked map is, and keeps that for as long as the map is
/// there. One scale is kept: that of the last map measured. From the service's thread.
class MapScaleKeeper {
 public:
  /// All outlive it.
  MapScaleKeeper(const CameraModel& camera, const SharedMemory& memory, const ArLink& link,
                 const PoseWait& poses)
      : camera_(camera), memory_(memory), link_(link), poses_(poses) {}

  /// Measures by points of the picture as it is now, or, after "snapshot ", of the last snapshot:
  /// `[snapshot] [diameter] MM X1,Y1 X2,Y2`. Throws InputError with one line on why not; the scale
  /// then stays what it was.
  MapScale measure(std::string_view request);
  /// Looks up, for a fifth of a second at most, from where the picture of a snapshot was taken.
  /// `frame` negative: it is not a picture from the scope. False when the AR process had no time
  /// for this picture but has looked at a later one: the next may fare better.
  bool noteSnapshot(std::int64_t frame);
  /// Another AR process has started: its maps are others, and there is no surface of it yet.
  void arStarted();
  /// All maps are forgotten.
  void forget();

  /// The scale of a surface, or of the map that is tracked, if it is known.
  std::optional<MapScale> of(const SurfaceMesh& mesh) const;
  std::optional<MapScale> ofTrackedMap() const;

 private:
  bool surfaceIsCurrent() const;
  SurfaceMesh surface() const;
  PoseEstimate poseOfSnapshot() const;
  PoseEstimate poseNow() const;

  CameraModel camera_;
  const SharedMemory& memory_;
  const ArLink& link_;
  const PoseWait& poses_;
  std::optional<MapScale> scale_;
  std::optional<PoseEstimate> snapshot_pose_;
  std::uint64_t surfaces_before_ = 0;  // published by AR processes that are gone
};

}  // namespace depthscope::platform
