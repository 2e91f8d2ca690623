#pragma once
#include <span>
#include <vector>

#include "slam/frame_records.hpp"

namespace depthscope::slam {

/// Keeps the map lean and within its capacity (Mur-Artal et al. 2015, sections VI.B and VI.E).
/// Locks the map's mutex.
class MapCuller {
 public:
  MapCuller(const SlamSettings& settings, Map& map, FrameRecords& records);

  /// Drops of the recently created points those that were seldom found where they should have been
  /// seen, or that too few keyframes came to see; forgets those that passed.
  void cullRecentPoints(std::vector<PointRef>& recent, std::int64_t current_serial);
  /// Removes those of `candidates` nearly all of whose points at least three others see as well or
  /// better.
  void cullKeyframes(std::span<const KeyframeId> candidates);
  /// Frees `slots` keyframe slots, and enough point slots, by dropping the least useful keyframes:
  /// redundant, old, far from the newest. Points that nobody else sees go with them.
  void makeRoom(int slots);

 private:
  double redundancy(KeyframeId id) const;
  double dispensability(KeyframeId id, KeyframeId newest);
  KeyframeId newest() const;
  KeyframeId leastUseful();
  void remove(KeyframeId id);
  /// Who takes over the frames that hang on `id`; kNone when no other keyframe is in its map.
  KeyframeId heirOf(KeyframeId id);

  MapperSettings settings_;
  int points_needed_;  // free point slots to keep
  Map& map_;
  FrameRecords& records_;
  std::vector<int> votes_;
};

}  // namespace depthscope::slam
