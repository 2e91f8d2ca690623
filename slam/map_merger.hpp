#pragma once
#include <span>

#include "slam/place_recognizer.hpp"
#include "slam/point_fuser.hpp"

namespace depthscope::slam {

/// Makes one of two connected maps when a place is recognised that both show. Called by the mapper,
/// which adjusts the seam afterwards. Allocates nothing.
class MapMerger {
 public:
  MapMerger(Map& map, PointFuser& fuser) : map_(map), fuser_(fuser) {}

  /// Takes the younger map into the world of the older one (labels and surfaces are fixed to the
  /// older), makes the points of `pairs` one, and fuses what else the keyframes around `link.now`,
  /// `around_now`, see twice with the `window` around `link.before`.
  void merge(const PlaceLink& link, std::span<const PointPair> pairs,
             std::span<const KeyframeId> window, std::span<const KeyframeId> around_now);
  /// The second half of it, for both ends of a loop.
  void fuse(const PlaceLink& link, std::span<const PointPair> pairs,
            std::span<const KeyframeId> window, std::span<const KeyframeId> around_now);

 private:
  Map& map_;
  PointFuser& fuser_;
};

}  // namespace depthscope::slam
