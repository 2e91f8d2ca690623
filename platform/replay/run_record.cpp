#include "platform/replay/run_record.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "platform/allocation_hook.hpp"
#include "platform/peak_memory.hpp"

namespace depthscope::platform {
namespace {

using Json = nlohmann::ordered_json;

Json stageJson(const Histogram& h) {
  return {{"count", h.count()},
          {"p50", h.percentile(0.5)},
          {"p95", h.percentile(0.95)},
          {"p99", h.percentile(0.99)},
          {"max", h.max()}};
}

/// One line of TUM format; fixed digits, so that equal poses give equal bytes.
void writePose(std::ofstream& out, double timestamp_s, Eigen::Quaterniond q,
               const Eigen::Vector3d& t) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  char line[256];
  std::snprintf(line, sizeof line, "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", timestamp_s, t.x(),
                t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  out << line;
}

void closeChecked(std::ofstream& out, const std::filesystem::path& path) {
  out.close();
  if (!out) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace

void RunRecord::add(const PoseEstimate& estimate, const slam::StageTimes& times) {
  metrics_.extract.add(times.extract_ms);
  metrics_.track.add(times.track_ms);
  if (times.map_ms >= 0) metrics_.map.add(times.map_ms);
  if (estimate.state != TrackingState::Tracking) return;
  if (metrics_.first_tracked_frame < 0) {
    metrics_.first_tracked_frame = estimate.frame;
    allocations_when_warm_ = countedAllocations();
  }
  ++metrics_.tracked_frames;
  const Pose T_world_camera = estimate.T_camera_world.inverse();
  live_.push_back({estimate.timestamp_s, estimate.map_id, T_world_camera.quaternion().cast<float>(),
                   T_world_camera.t.cast<float>()});
}

void RunRecord::close() {
  const auto allocations = countedAllocations();
  if (allocations)
    metrics_.steady_state_allocations =
        allocations_when_warm_ ? *allocations - *allocations_when_warm_ : 0;
}

void writeTrajectory(const std::filesystem::path& path,
                     const std::vector<slam::StampedPose>& poses) {
  std::ofstream out(path);
  for (const slam::StampedPose& pose : poses)
    writePose(out, pose.timestamp_s, pose.T_world_camera.quaternion(), pose.T_world_camera.t);
  closeChecked(out, path);
}

void writeLiveTrajectory(const std::filesystem::path& path, const std::vector<LivePose>& live,
                         std::uint32_t map_id) {
  std::ofstream out(path);
  for (const LivePose& pose : live)
    if (pose.map_id == map_id)
      writePose(out, pose.timestamp_s, pose.q_world_camera.cast<double>().normalized(),
                pose.t_world_camera.cast<double>());
  closeChecked(out, path);
}

void writeMetrics(const std::filesystem::path& path, const RunMetrics& m) {
  constexpr double kMb = 1024.0 * 1024.0;
  Json json{{"frames", m.frames},
            {"dropped_frames", m.dropped_frames},
            {"tracked_frames", m.tracked_frames},
            {"first_tracked_frame", m.first_tracked_frame},
            {"lost_events", m.slam.lost_events},
            {"relocalizations", m.slam.relocalizations},
            {"loops_closed", m.slam.loops_closed},
            {"readout_ms", 1000 * m.slam.readout_s},
            {"tissue_rhythm_hz", m.tissue_rhythm_hz},
            {"maps", m.slam.maps},
            {"keyframes", m.slam.keyframes},
            {"map_points", m.slam.map_points},
            {"surfaces", m.surfaces},
            {"surface_triangles", m.surface_triangles},
            {"map_mb", static_cast<double>(m.slam_memory.total()) / kMb},
            {"peak_rss_mb", peakResidentMb()}};
  json["mm_per_unit"] = m.scale ? Json(m.scale->mm_per_unit) : Json(nullptr);
  json["mm_per_unit_uncertainty"] = m.scale ? Json(m.scale->uncertainty_mm) : Json(nullptr);
  json["steady_state_allocations"] =
      m.steady_state_allocations ? Json(*m.steady_state_allocations) : Json(nullptr);
  json["reconstruct_peak_mb"] = m.reconstruct_peak_bytes
                                    ? Json(static_cast<double>(*m.reconstruct_peak_bytes) / kMb)
                                    : Json(nullptr);
  json["extract_ms"] = stageJson(m.extract);
  json["track_ms"] = stageJson(m.track);
  json["map_ms"] = stageJson(m.map);
  json["reconstruct_ms"] = stageJson(m.reconstruct);
  json["composite_ms"] = stageJson(m.composite);
  std::ofstream out(path);
  out << json.dump(2) << '\n';
  closeChecked(out, path);
}

}  // namespace depthscope::platform
