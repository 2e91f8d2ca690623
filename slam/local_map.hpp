#pragma once
#include <span>
#include <vector>

#include "slam/map.hpp"

namespace depthscope::slam {

/// What tracking needs of a map point, copied so that tracking goes on while the mapper works.
struct LocalPoint {
  PointRef ref;
  Eigen::Vector3d position;
  Eigen::Vector3f normal;  // mean viewing direction, from the cameras to the point
  float min_distance, max_distance;
  Descriptor descriptor;
  float weight;  // MapPoint::poseWeight()
  bool tracked;  // the frame has it already
};

/// A copy of the part of the map around the camera. Arrays of fixed capacity; methods that read the
/// map must be called with its mutex held.
class LocalMap {
 public:
  LocalMap(const SlamSettings& settings);

  /// Collects the points of the keyframes that share most points with `tracked`, and of the
  /// keyframes that share most with the best of these (Mur-Artal et al. 2015, section V.D).
  void collect(const Map& map, std::span<const PointRef> tracked);

  std::span<const LocalPoint> points() const { return points_; }
  /// The keyframe that shares most points with the frame; kNone when none does.
  KeyframeId reference() const { return reference_; }

 private:
  void addKeyframe(KeyframeId id);

  int max_keyframes_;
  std::vector<LocalPoint> points_;
  std::vector<int> votes_, neighbour_votes_;  // per keyframe
  std::vector<KeyframeId> chosen_;
  std::vector<std::int64_t> point_stamp_, keyframe_stamp_;  // collect() that last took them
  std::vector<std::int64_t> tracked_stamp_;                 // likewise, of the frame's points
  std::int64_t stamp_ = 0;
  KeyframeId reference_ = kNone;
};

/// Copies one live point.
LocalPoint makeLocalPoint(const Map& map, PointId id);

}  // namespace depthscope::slam
