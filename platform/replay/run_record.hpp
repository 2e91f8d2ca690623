#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "platform/histogram.hpp"
#include "platform/map_scale.hpp"
#include "slam/slam_system.hpp"
#include "types/tracking.hpp"

namespace depthscope::platform {

/// What one replay measured; written as metrics.json.
struct RunMetrics {
  std::int64_t frames = 0;  // of the clip
  std::int64_t dropped_frames =
      0;  // of these, never tracked because newer ones were there (real time)
  std::int64_t tracked_frames = 0;
  std::int64_t first_tracked_frame = -1;
  std::size_t surface_triangles = 0;
  std::int64_t surfaces = 0;  // reconstructed
  double pictures_ms = 0;     // spent on keyframes' pictures since the last surface
  slam::SlamStatistics slam;
  slam::SlamMemory slam_memory;
  double tissue_rhythm_hz = 0;    // that the trajectory allows for; 0: none was found
  std::optional<MapScale> scale;  // of the main map
  std::optional<std::uint64_t> steady_state_allocations;
  std::optional<std::int64_t> reconstruct_peak_bytes;  // of the heap, held by reconstruction
  Histogram extract, track, map, reconstruct, composite;
};

/// A pose as it was given out. Packed, for every frame of a clip is kept.
struct LivePose {
  double timestamp_s = 0;
  std::uint32_t map_id = 0;
  Eigen::Quaternion<float, Eigen::DontAlign> q_world_camera;
  Eigen::Vector3f t_world_camera;
};

/// Follows tracking frame by frame: counts, times, live poses, and the allocations made by tracking
/// and mapping since the first map was there.
class RunRecord {
 public:
  /// Room for this many live poses is made at once.
  explicit RunRecord(std::int64_t expected_frames) {
    live_.reserve(static_cast<std::size_t>(expected_frames));
  }

  /// Once after every call of SlamSystem::track().
  void add(const PoseEstimate& estimate, const slam::StageTimes& times);
  /// Once at the end.
  void close();

  RunMetrics& metrics() { return metrics_; }
  const RunMetrics& metrics() const { return metrics_; }
  /// Every tracked pose as it was given out, in order.
  const std::vector<LivePose>& live() const { return live_; }

 private:
  RunMetrics metrics_;
  std::vector<LivePose> live_;
  std::optional<std::uint64_t> allocations_when_warm_;
};

/// Writes poses in TUM format. Throws std::runtime_error when the file cannot be written.
void writeTrajectory(const std::filesystem::path& path,
                     const std::vector<slam::StampedPose>& poses);
/// The tracked poses of one map. Throws like writeTrajectory.
void writeLiveTrajectory(const std::filesystem::path& path, const std::vector<LivePose>& live,
                         std::uint32_t map_id);
/// Throws std::runtime_error when the file cannot be written.
void writeMetrics(const std::filesystem::path& path, const RunMetrics& metrics);

}  // namespace depthscope::platform
