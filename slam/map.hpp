#pragma once
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "slam/features.hpp"
#include "slam/projection.hpp"
#include "slam/rolling_shutter.hpp"
#include "slam/sim3.hpp"
#include "slam/slam_settings.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

using PointId = std::int32_t;
using KeyframeId = std::int32_t;
inline constexpr std::int32_t kNone = -1;

/// A point as somebody outside the map remembers it: its slot may since have been given to another.
struct PointRef {
  PointId id = kNone;
  std::uint32_t generation = 0;
};

struct Observation {
  KeyframeId keyframe = kNone;
  std::int32_t feature = kNone;  // index into the keyframe's features
};

/// A landmark. Distances and directions are in the map's unit and world frame.
struct MapPoint {
  bool alive = false;
  std::uint32_t map_id = 0;      // the connected map it belongs to
  std::uint32_t generation = 0;  // of this slot; grows when the slot is freed
  PointRef replaced_by;          // after a merge: where this point lives on
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal =
      Eigen::Vector3d::Zero();               // mean direction from the cameras to the point, unit
  float min_distance = 0, max_distance = 0;  // range in which its pyramid levels can see it
  Descriptor descriptor;                     // the observation's nearest to all the others
  std::int64_t born_serial = 0;              // serial of the keyframe that made it
  std::int32_t visible = 0, found = 0;       // frames in which it should have been, and was, seen
  std::int32_t observation_count = 0;
  // Mean of its squared reprojection errors over their variance, in the frames of late in which it
  // was recognised. The noise of corners makes 0.8 of it (they lie within 0.44 px,
  // keypoint_sigma_px is 0.7), give or take as much.
  // A new point starts with what a moving one has, for an instrument that moves slowly looks still:
  // until a point has stayed put for half a second, those that have count for more. With a textured
  // instrument that moves over a quarter of the picture the path went with it before (of a sweep, a
  // hovering scope: 16 and 52 mm off), now it is the tissue's (0.7, 0.3).
  float residual = 6;
  /// Weight in bundle adjustment, 0..1: less for what moves, breathes or is an instrument. At the
  /// end of a clip half of the points lie above 1.7 (rendered tissue, still or breathing) to 2.9
  /// (hand-held camera), a quarter above 3.1 to 5.3. With weights from 1.6 on paths were off by
  /// 0.671 instead of 0.656 mm (sweep), 40.4 instead of 39.0 mm (hand-held), 0.145 instead of 0.118
  /// (sample) and 0.106 instead of 0.115 (hovering; means of five runs each).
  float trust() const { return residual > 3 ? 3 / residual : 1.f; }
  /// Weight in the pose of a frame, relative to other points. Where there are many of what moves,
  /// its variance (trust) alone lets them win; a steeper fall is that of robust costs that
  /// redescend. With the third power an instrument that moves over a quarter of the picture took
  /// the path with it (of a sample 7 mm off instead of 0.2, of a sweep 14 instead of 0.7).
  float poseWeight() const {
    const float t = trust();
    return t * t * t * t * t;
  }
};

struct Keyframe {
  bool alive = false;
  std::uint32_t map_id = 0;  // the connected map it belongs to
  std::int64_t serial = 0;   // order of creation, never reused
  std::int64_t frame = 0;
  double timestamp_s = 0;
  Pose T_camera_world;  // at the time of the middle row
  Twist twist;          // then; written by the tracker, too, under the mutex
  double unit = 1;      // product of all factors by which lengths around it have grown since
  FeatureSet features;
  std::vector<PointId> points;  // per feature, kNone where it observes none
};

/// Keyframes, points and who sees whom, in fixed-capacity arrays addressed by index. After a loss
/// there may be several connected maps, each with a world frame of its own, told apart by `map_id`;
/// what is added belongs to the active one. One thread, the mapper's (or the tracker's while the
/// mapper is drained), changes it and holds `mutex` while it does; others hold `mutex` while they
/// read. The writer may read without it, but for what the tracker counts in points, with the mutex:
/// their sightings and residuals. Nothing is allocated after construction.
class Map {
 public:
  Map(const SlamSettings& settings, const CameraModel& camera);

  mutable std::mutex mutex;
  /// Held, and locked before `mutex`, by whom moves the world under the tracker (correctWorld) and
  /// by the tracker while it goes from one pose to the next.
  std::mutex world_mutex;

  /// Forgets all keyframes and points.
  void clear();
  /// Starts a new connected map beside the others and makes it the active one.
  void start() { active_id_ = ++last_id_; }
  void activate(std::uint32_t map_id) { active_id_ = map_id; }
  std::uint32_t activeId() const { return active_id_; }
  std::uint32_t lastId() const { return last_id_; }  // of the newest map; ids start at 1
  /// Removes the keyframes, and so the points, of one connected map.
  void removeMap(std::uint32_t map_id);
  int keyframesOf(std::uint32_t map_id) const;

  /// A free slot, or kNone when full. Keyframe features are copied in.
  KeyframeId addKeyframe(const FeatureSet& features, const Pose& T_camera_world, std::int64_t frame,
                         double timestamp_s);
  PointId addPoint(const Eigen::Vector3d& position, std::int64_t born_serial);
  void removeKeyframe(
      KeyframeId id);  // with every observation it holds; points left with < 2 go too
  void removePoint(PointId id);
  /// All observations of `from` pass to `into` (where the keyframe does not see both), `from` goes.
  void mergePoints(PointId from, PointId into);

  /// Records that `feature` of `keyframe` sees `point`; false when either is taken or the point is
  /// full.
  bool observe(PointId point, KeyframeId keyframe, int feature);
  void unobserve(PointId point, KeyframeId keyframe);
  /// Recomputes descriptor, normal and distance range from the observations.
  void refreshPoint(PointId id);
  /// Normal and distance range alone, after poses or positions have moved.
  void refreshGeometry(PointId id);

  /// MapPoint::trust() for the writer. Takes the mutex.
  float trustOf(PointId id) const {
    const std::lock_guard lock(mutex);
    return points_[id].trust();
  }

  /// Keyframe::twist for the writer. Takes the mutex.
  Twist twistOf(KeyframeId id) const {
    const std::lock_guard lock(mutex);
    return keyframes_[id].twist;
  }

  std::span<const Observation> observations(PointId id) const;
  bool isObservedBy(PointId point, KeyframeId keyframe) const;
  /// The live point behind a reference, through merges; kNone when it is gone.
  PointId resolve(PointRef ref) const;
  PointRef ref(PointId id) const { return {id, points_[id].generation}; }

  MapPoint& point(PointId id) { return points_[id]; }
  const MapPoint& point(PointId id) const { return points_[id]; }
  Keyframe& keyframe(KeyframeId id) { return keyframes_[id]; }
  const Keyframe& keyframe(KeyframeId id) const { return keyframes_[id]; }
  int keyframeCapacity() const { return static_cast<int>(keyframes_.size()); }
  int pointCapacity() const { return static_cast<int>(points_.size()); }
  int keyframeCount() const { return keyframe_count_; }
  int pointCount() const { return point_count_; }
  int freeKeyframes() const { return static_cast<int>(free_keyframes_.size()); }
  std::int64_t nextSerial() const { return next_serial_; }
  /// One past the largest slot ever used; live ids are below it.
  int pointEnd() const { return point_end_; }
  const Intrinsics& intrinsics() const { return intrinsics_; }
  RollingShutter& shutter() { return shutter_; }
  const RollingShutter& shutter() const { return shutter_; }

  /// Votes: into `votes[k]` the number of points that `id` shares with keyframe k (size
  /// keyframeCapacity()).
  void countShared(KeyframeId id, std::span<int> votes) const;
  /// Median depth [map unit] of the points a keyframe sees, in its camera; <= 0 when it sees none.
  double medianDepth(KeyframeId id);
  /// Multiplies the unit of length of the active map.
  void rescale(double factor);

  /// Moves a keyframe, or a point, with the world around it.
  void moveKeyframe(KeyframeId id, const Sim3& T_new_old);
  void movePoint(PointId id, const Sim3& T_new_old);
  /// Moves all of one connected map into the world of another, of which it becomes a part.
  void join(std::uint32_t from, std::uint32_t into, const Sim3& T_into_from);
  /// Connected maps that have keyframes.
  int mapCount() const;
  /// Tells the tracker that the world around the camera was moved: poses it remembers are of the
  /// old one. `world_mutex` and `mutex` held.
  void correctWorld(const Sim3& T_new_old) {
    correction_ = T_new_old * correction_;
    correction_.R = orthonormal(correction_.R);
    ++corrections_;
  }
  /// All of these moves together, and their number.
  const Sim3& correction() const { return correction_; }
  int corrections() const { return corrections_; }

  float scaleOf(int octave) const { return scales_[octave]; }
  int levels() const { return static_cast<int>(scales_.size()); }
  /// Pyramid level at which a point is expected at `distance`, given its `max_distance`.
  int predictLevel(double max_distance, double distance) const;
  std::size_t keyframeBytes() const;
  std::size_t pointBytes() const;

 private:
  void dropObservation(PointId point, KeyframeId keyframe);

  Intrinsics intrinsics_;
  RollingShutter shutter_;
  std::uint32_t active_id_ = 0, last_id_ = 0;
  Sim3 correction_;
  int corrections_ = 0;
  std::vector<Keyframe> keyframes_;
  std::vector<MapPoint> points_;
  std::vector<Observation> observations_;  // observations_per_point slots for each point
  int observations_per_point_;
  std::vector<KeyframeId> free_keyframes_;
  std::vector<PointId> free_points_;
  std::vector<float> scales_;
  double log_scale_factor_;
  std::vector<double> depth_scratch_;
  std::int64_t next_serial_ = 0;
  int keyframe_count_ = 0, point_count_ = 0, point_end_ = 0;
};

}  // namespace depthscope::slam
