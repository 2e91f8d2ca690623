#pragma once
#include <optional>
#include <span>
#include <vector>

#include "slam/relocalizer.hpp"
#include "slam/sim3.hpp"

namespace depthscope::slam {

/// Locates a keyframe in the other connected maps as if its camera were lost there: all corners of
/// its picture are matched with their points, not only the few that bear a point of its own map
/// already. These few, where both maps know them, tell the scale. What it finds is a guess to be
/// verified. Called by the mapper; reads the map without its mutex. Allocates nothing.
class CrossMapLocator {
 public:
  CrossMapLocator(const SlamSettings& settings, const Map& map, const KeyframeDatabase& database);

  /// The next few keyframes of other maps to try for `now`, in the order of their similarity, until
  /// every one had its turn: between views from different sides similarity says little. They live
  /// until the next call.
  std::span<const KeyframeId> candidates(KeyframeId now);

  /// T_before_now, the similarity from the world of `now` to that of `before`.
  std::optional<Sim3> locate(KeyframeId now, KeyframeId before);

 private:
  std::optional<double> scale(const Keyframe& now, const Pose& T_now_before);

  const Map& map_;
  const KeyframeDatabase& database_;
  Relocalizer relocalizer_;
  PlaceQuery query_;
  std::vector<KeyframeId> candidates_;
  std::vector<PointRef> points_;      // per feature of `now`: its point in the other map
  std::vector<double> depth_ratios_;  // of points that both maps have
  std::ptrdiff_t next_ = 0;           // rank of the first candidate of the next call
};

}  // namespace depthscope::slam
