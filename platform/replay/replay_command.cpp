#include "platform/replay/replay_command.hpp"

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "platform/interrupt.hpp"
#include "platform/replay/output_directory.hpp"
#include "platform/replay/replay_clip.hpp"
#include "platform/surface_writer.hpp"
#include "recon/mesh_io.hpp"

namespace depthscope::platform {
namespace {

const std::vector<std::string_view> output_files = {
    "trajectory.txt", "trajectory_live.txt", "map.ply",     "surface.ply",
    "overlay.mp4",    "snapshot.png",        "metrics.json"};

/// In the unit of length of the trajectory, whatever is known of its scale.
void writeSurfaceFile(const std::filesystem::path& path, const ReplayResult& result) {
  std::ofstream out(path, std::ios::binary);
  writeSurface(out, result.surface, SurfaceFormat::Ply, result.record.metrics().scale,
               Lengths::MapUnits);
  out.close();
  if (!out) throw std::runtime_error(path.string() + ": cannot be written");
}

void writeResults(const ReplayOptions& options, const ReplayResult& result,
                  const OutputDirectory& out) {
  writeTrajectory(out.file("trajectory.txt"), result.trajectory);
  writeLiveTrajectory(out.file("trajectory_live.txt"), result.record.live(), result.cloud.map_id);
  recon::writePly(out.file("map.ply"), result.cloud);
  if (options.surface) writeSurfaceFile(out.file("surface.ply"), result);
  writeMetrics(out.file("metrics.json"), result.record.metrics());
}

void printSummary(const ReplayOptions& options, const RunMetrics& m) {
  const double share =
      m.frames > 0 ? 100.0 * static_cast<double>(m.tracked_frames) / static_cast<double>(m.frames)
                   : 0;
  std::printf("%lld frames, %lld tracked (%.1f %%)", static_cast<long long>(m.frames),
              static_cast<long long>(m.tracked_frames), share);
  if (m.tracked_frames > 0)
    std::printf(" from frame %lld on", static_cast<long long>(m.first_tracked_frame));
  std::printf(", lost %d times, %d keyframes, %d points, %zu triangles\n", m.slam.lost_events,
              m.slam.keyframes, m.slam.map_points, m.surface_triangles);
  std::printf("medians: track %.1f ms, map %.1f ms, reconstruct %.0f ms, composite %.1f ms\n",
              m.track.percentile(0.5), m.map.percentile(0.5), m.reconstruct.percentile(0.5),
              m.composite.percentile(0.5));
  if (m.scale) std::printf("scale: %s\n", toString(*m.scale).c_str());
  std::printf("results in %s\n", options.out.c_str());
}

}  // namespace

int replayCommand(Arguments arguments) {
  if (arguments.flag("--help")) {
    std::fputs(replay_help, stdout);
    return 0;
  }
  const ReplayOptions options = parseReplayOptions(std::move(arguments));
  catchInterrupts();
  OutputDirectory out(options.out);
  ReplayClip clip = openReplayClip(options);
  std::optional<OverlayRecorder> recorder;
  if (options.overlay)
    recorder.emplace(options.camera, options.settings.overlay, clip.fps, out.file("overlay.mp4"));
  OverlayRecorder* const overlay = recorder ? &*recorder : nullptr;
  ReplayResult result = options.realtime ? replayRealtime(options, clip, overlay)
                                         : replayLockstep(options, clip, overlay);
  takeScale(options, result);
  if (recorder) recorder->finish(out.file("snapshot.png"));
  writeResults(options, result, out);
  out.commit(output_files);
  printSummary(options, result.record.metrics());
  return 0;
}

}  // namespace depthscope::platform
