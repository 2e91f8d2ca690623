#pragma once
#include <atomic>
#include <span>
#include <vector>

#include "slam/bundle_adjuster.hpp"
#include "slam/map.hpp"

namespace depthscope::slam {

/// Bundle adjustment of a window of the map: the window's keyframes and all points they see move,
/// other keyframes that see these points hold still (Mur-Artal et al. 2015, section VI.D).
class LocalBundle {
 public:
  LocalBundle(const SlamSettings& settings, Map& map, BundleAdjuster& adjuster);

  /// Adjusts `window`. Observations found to be outliers are removed. Reads the map without, writes
  /// it with its mutex; stops early when `stop` becomes true.
  BaSummary adjust(std::span<const KeyframeId> window, int iterations,
                   const std::atomic<bool>* stop);

 private:
  void gather(std::span<const KeyframeId> window);
  void gatherPoints(std::span<const KeyframeId> window);
  void chooseFixed();
  void addObservations();
  void writeBack();

  Map& map_;
  int max_fixed_;
  BundleAdjuster& adjuster_;           // big enough for the window and what is held fixed around it
  std::vector<int> pose_index_;        // per keyframe, kNone: not in the problem
  std::vector<Twist> twists_;          // per pose of the problem
  std::vector<int> shared_;            // per keyframe: observations of the gathered points
  std::vector<KeyframeId> keyframes_;  // per pose of the problem
  std::vector<KeyframeId> outside_;    // candidates for fixed poses
  std::vector<PointId> points_;        // per point of the problem
  std::vector<std::int64_t> stamp_;    // per map point
  std::int64_t current_stamp_ = 0;
};

}  // namespace depthscope::slam
