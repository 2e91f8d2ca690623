#pragma once
#include <span>
#include <vector>

#include "slam/map.hpp"
#include "slam/matcher.hpp"

namespace depthscope::slam {

/// Finds map points that are the same piece of tissue and makes them one, and finds further
/// observations of points in keyframes that missed them.
class PointFuser {
 public:
  PointFuser(const SlamSettings& settings, Map& map);

  /// Projects the points of `keyframe` into every neighbour and theirs into it. Locks the map's
  /// mutex to write.
  void fuse(KeyframeId keyframe, std::span<const KeyframeId> neighbours);

 private:
  void fuseInto(KeyframeId target, std::span<const PointId> points);
  int findFeature(const Keyframe& target, const Twist& twist, const MapPoint& point);

  MatchingSettings settings_;
  Map& map_;
  std::vector<PointId> points_;  // of the neighbours, each once
  std::vector<std::int64_t> stamp_;
  std::int64_t current_stamp_ = 0;
  std::vector<std::uint32_t> candidates_;
};

}  // namespace depthscope::slam
