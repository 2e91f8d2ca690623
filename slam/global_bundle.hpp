#pragma once
#include <atomic>
#include <span>
#include <vector>

#include "slam/bundle_adjuster.hpp"
#include "slam/map.hpp"

namespace depthscope::slam {

/// Bundle adjustment of a whole connected map (Mur-Artal et al. 2015, section VII): all keyframes
/// but the oldest move, and the map keeps its size. Where not all points fit the adjuster, it is
/// the best observed ones of every keyframe; the others go along with the keyframe that saw them
/// first.
class GlobalBundle {
 public:
  /// Works in the memory of an adjuster that it shares with the local adjustment.
  GlobalBundle(const SlamSettings& settings, Map& map, BundleAdjuster& adjuster);

  /// Takes up to `iterations` steps. Reads the map without its mutexes, writes it with them. Stops
  /// early when `stop` becomes true, and keeps what has been gained; observations found to be
  /// outliers are removed only when it has not been stopped.
  BaSummary adjust(std::uint32_t map_id, int iterations, const std::atomic<bool>* stop);
  /// Tells the map's shutter what the map, as it is, says of its readout; adjust() does, too,
  /// unless it is stopped.
  void estimateReadout(std::uint32_t map_id);

 private:
  void correctShutter();
  void gather(std::uint32_t map_id);
  void choosePoints();
  bool choosePointsOf(KeyframeId keyframe, int quota);
  bool choose(PointId point);
  void fixOldest();
  void keepScale();
  void findMotions();
  double medianGrowth(std::size_t pose);
  void writeBack(std::uint32_t map_id, bool remove_outliers);
  int newest() const;

  Map& map_;
  BundleAdjuster& adjuster_;
  int max_quota_;                      // points that a keyframe can have
  std::vector<KeyframeId> keyframes_;  // per pose of the problem
  std::vector<int> pose_index_;        // per keyframe
  int oldest_ = 0;                     // pose that is held
  std::vector<PointId> points_;        // per point of the problem
  std::vector<int> point_index_;       // per map point, -1: not in the problem
  std::vector<PointId> ranked_;        // of one keyframe, the best observed first
  std::vector<Twist> twists_;          // per pose of the problem
  std::vector<Sim3> T_new_old_;        // per pose of the problem
  std::vector<double> growth_;         // of one keyframe's depths, scratch
};

}  // namespace depthscope::slam
