#pragma once
#include <vector>

#include "slam/map.hpp"
#include "slam/slam_system.hpp"

namespace depthscope::slam {

/// Poses of tracked frames relative to keyframes, so that they follow every later correction of the
/// map. A ring of fixed capacity. Guarded by the map's mutex.
class Trajectory {
 public:
  explicit Trajectory(std::int64_t capacity) {
    records_.resize(static_cast<std::size_t>(capacity));
  }

  /// `unit` of the reference keyframe at this time: the record grows with it.
  void add(std::int64_t frame, double timestamp_s, KeyframeId reference,
           const Pose& T_camera_reference, double unit = 1);
  /// Records that hang on keyframe `from` hang on `to` afterwards; call before `from` is removed.
  void rebase(const Map& map, KeyframeId from, KeyframeId to);
  /// Forgets the records of a connected map.
  void dropMap(const Map& map, std::uint32_t map_id);
  /// Forgets the records that hang on a keyframe.
  void drop(KeyframeId reference);
  void clear() { count_ = next_ = 0; }
  /// The connected map that most frames were tracked in; the newer one of equals.
  std::uint32_t mainMap(const Map& map) const;
  /// Poses of the frames tracked in one connected map, in order of time.
  std::vector<StampedPose> corrected(const Map& map, std::uint32_t map_id) const;

 private:
  /// One frame, packed: a day of them is kept. Relative to a keyframe nearby single precision is a
  /// hundred times finer than any pose is known.
  struct Record {
    std::int64_t frame;
    double timestamp_s;
    KeyframeId reference;  // kNone: dropped
    float unit;            // Keyframe::unit of the reference when this was recorded
    Eigen::Quaternion<float, Eigen::DontAlign> q_camera_reference;
    Eigen::Vector3f t_camera_reference;

    void set(const Pose& T_camera_reference);
    /// T_camera_reference in the unit of length of now.
    Pose now(const Map& map) const;
  };
  std::vector<Record> records_;
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace depthscope::slam
