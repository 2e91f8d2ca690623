#pragma once
#include <vector>

#include "slam/anchored_pose.hpp"

namespace depthscope::slam {

/// Frames whose pictures are worth being kept for reconstruction: keyframes, also after they were
/// culled, and what was seen from new places between them. Tracking needs few keyframes where the
/// same points stay in sight; stereo needs views all along the way. Fixed capacity: when full, the
/// view that has another one nearest to it goes. Guarded by the map's mutex.
class ViewKeeper {
 public:
  /// `min_motion`: how far a view must be from all others of its map; see motionBetween().
  ViewKeeper(int capacity, double min_motion) : min_motion_(min_motion) {
    views_.resize(static_cast<std::size_t>(capacity));
  }

  /// Whether the picture of a frame is to be kept; if so it is one of the views from now on.
  /// `depth`: of the scene before the camera [map unit].
  bool offer(const Map& map, const AnchoredPose& frame, double depth, bool keyframe);
  /// A view has become a keyframe, whose pose is known better.
  void becameKeyframe(const Map& map, std::int64_t frame, KeyframeId keyframe);
  void clear() { count_ = 0; }
  std::span<AnchoredPose> poses() { return std::span(views_).first(count_); }
  std::span<const AnchoredPose> poses() const { return std::span(views_).first(count_); }

 private:
  std::size_t mostRedundant(const Map& map, double depth) const;

  double min_motion_;
  std::vector<AnchoredPose> views_;
  std::size_t count_ = 0;
};

}  // namespace depthscope::slam
