#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "slam/slam_settings.hpp"
#include "types/camera_model.hpp"
#include "types/image_view.hpp"
#include "types/sparse_cloud.hpp"
#include "types/tracking.hpp"
#include "types/view_outline.hpp"

namespace depthscope::slam {

/// Who runs the mapper: the caller of track(), before it returns (same input, same output), or a
/// thread of its own (live).
enum class MappingMode { Lockstep, Threaded };

/// Milliseconds the last call of track() spent; `map_ms` is the mapper's work for the last
/// keyframe, and is negative when no keyframe was processed since the call before.
struct StageTimes {
  double extract_ms = 0;
  double track_ms = 0;  // whole of tracking, extraction included, mapping excluded
  double map_ms = -1;
};

struct SlamStatistics {
  int keyframes = 0;
  int map_points = 0;
  int maps = 0;  // connected maps that have keyframes
  int lost_events = 0;
  int relocalizations = 0;
  int loops_closed = 0;
  double readout_s = 0;  // found out from the first row's exposure to the last's; 0: all at once
};

/// Bytes set aside at start, by what takes them; they never grow.
struct SlamMemory {
  std::size_t keyframes = 0;   // with their features
  std::size_t points = 0;      // with their observations
  std::size_t places = 0;      // vocabulary and inverted index
  std::size_t adjustment = 0;  // workspaces of bundle adjustment and loop closing
  std::size_t total() const { return keyframes + points + places + adjustment; }
};

struct StampedPose {
  std::int64_t frame = 0;
  double timestamp_s = 0;
  Pose T_world_camera;
};

/// Where the scope was, as far as breathing tissue lets it be told.
struct ScopePath {
  std::vector<StampedPose> poses;
  double tissue_rhythm_hz = 0;  // that was found and allowed for; 0: none
};

/// Monocular ORB SLAM in fixed memory: all storage is allocated by the constructor. track() is
/// called from one thread; the const functions may be called from others at the same time.
class SlamSystem {
 public:
  /// `camera.width/height` is the size of the pictures that track() will get. Throws InputError
  /// when the vocabulary cannot be read.
  SlamSystem(const CameraModel& camera, const SlamSettings& settings, MappingMode mode);
  ~SlamSystem();

  /// Tracks one luma picture. `frame` grows from call to call (gaps allowed).
  PoseEstimate track(const GrayView& image, std::int64_t frame, double timestamp_s);

  /// Whether the picture of the last call of track() is one that reconstruction should keep: of a
  /// keyframe, or from a place that none was kept of. From the thread that tracks.
  bool wantsPicture() const;

  /// The view of the scope in the last picture given to track(). From the thread that tracks.
  ViewOutline view() const;

  StageTimes lastTimes() const;
  SlamStatistics statistics() const;
  SlamMemory memory() const;
  /// Copies points, poses of keyframes and of other kept views, and who saw what of the active map
  /// into `out`, whose capacity is reused.
  void copyCloud(SparseCloud& out) const;
  /// The same of the main map: the connected map that most frames were tracked in.
  void copyMainCloud(SparseCloud& out) const;
  /// Poses of the last `trajectory_frames` tracked frames, as far as they lie in the main map, as
  /// corrected by everything learnt since, in order of time.
  std::vector<StampedPose> correctedTrajectory() const;
  /// The same, where the tissue changes its shape in a rhythm of breathing with what that did to
  /// the poses taken back: the path of the scope, while the other is that of the scope over the
  /// tissue as each picture shows it. Takes memory, and up to seconds.
  ScopePath scopePath() const;
  /// Forgets everything and starts over.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace depthscope::slam
