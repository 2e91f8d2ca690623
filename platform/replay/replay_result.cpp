#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "platform/allocation_hook.hpp"
#include "platform/ar/capacity_text.hpp"
#include "platform/ar/surface_log.hpp"
#include "platform/log.hpp"
#include "platform/replay/replay_clip.hpp"
#include "platform/stopwatch.hpp"
#include "types/error.hpp"

namespace depthscope::platform {

void printCapacity(const ReplayOptions& options, const slam::SlamSystem& slam) {
  std::printf("room for %s\n", capacityText(options.settings.slam, slam.memory()).c_str());
}

bool reconstruct(recon::Reconstructor& reconstructor, const SparseCloud& cloud, SurfaceMesh& mesh,
                 RunMetrics& metrics) {
  const Stopwatch watch;
  const recon::ReconStatus status = reconstructor.reconstruct(cloud, mesh);
  logReconstruction(status, cloud.points.size(), reconstructor.lastChange());
  if (status != recon::ReconStatus::Ok) return false;
  metrics.reconstruct.add(watch.elapsedMs() + std::exchange(metrics.pictures_ms, 0));
  ++metrics.surfaces;
  return true;
}

void takeFinalMap(const slam::SlamSystem& slam, recon::Reconstructor* reconstructor,
                  ReplayResult& result) {
  RunMetrics& metrics = result.record.metrics();
  slam.copyMainCloud(result.cloud);
  if (reconstructor != nullptr) {
    reconstruct(*reconstructor, result.cloud, result.surface, metrics);
    if (countedAllocations()) metrics.reconstruct_peak_bytes = reconstructor->memory().peak_bytes;
  }
  // A surface of another map is not in the trajectory's frame.
  if (result.surface.map_id != result.cloud.map_id) result.surface.clear();
  metrics.surface_triangles = result.surface.triangles.size();
  metrics.slam = slam.statistics();
  metrics.slam_memory = slam.memory();
  slam::ScopePath path = slam.scopePath();
  metrics.tissue_rhythm_hz = path.tissue_rhythm_hz;
  result.trajectory = std::move(path.poses);
  if (path.tissue_rhythm_hz > 0) result.over_tissue = slam.correctedTrajectory();
}

void takeScale(const ReplayOptions& options, ReplayResult& result) {
  if (!options.scale) return;
  try {
    const auto& poses = result.over_tissue.empty() ? result.trajectory : result.over_tissue;
    const auto pose = std::find_if(poses.rbegin(), poses.rend(), [&](const slam::StampedPose& p) {
      return !options.scale_frame || p.frame == *options.scale_frame;
    });
    if (pose == poses.rend())
      throw InputError(options.scale_frame ? "frame " + std::to_string(*options.scale_frame) +
                                                 " was not tracked in the main map"
                                           : std::string("no frame was tracked"));
    if (result.surface.empty()) throw InputError("there is no surface");
    result.record.metrics().scale = measureScale(result.surface, options.camera,
                                                 pose->T_world_camera.inverse(), *options.scale);
  } catch (const InputError& error) {
    log(LogPriority::Warning, "scale not measured", {{"why", error.what()}});
  }
}

}  // namespace depthscope::platform
