#pragma once
#include "slam/essential_graph.hpp"
#include "slam/map_merger.hpp"

namespace depthscope::slam {

/// Closes a loop when a place is recognised that the same connected map shows twice (Mur-Artal et
/// al. 2015, section VII.C and D): spreads the drift over the essential graph, moves keyframes and
/// points along, and makes one of what the two ends see twice. Called by the mapper, which adjusts
/// the map afterwards. Allocates nothing.
class LoopCloser {
 public:
  LoopCloser(const SlamSettings& settings, Map& map, MapMerger& merger)
      : map_(map), merger_(merger), graph_(settings, map) {}

  /// False when the map would have to bend too much: then the place was mistaken, and nothing is
  /// changed.
  bool close(const PlaceLink& link, std::span<const PointPair> pairs,
             std::span<const KeyframeId> window, std::span<const KeyframeId> around_now);
  std::size_t bytes() const { return graph_.bytes(); }

 private:
  void moveMap(const PlaceLink& link);

  Map& map_;
  MapMerger& merger_;
  EssentialGraph graph_;
};

}  // namespace depthscope::slam
