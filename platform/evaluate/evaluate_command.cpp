#include "platform/evaluate/evaluate_command.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "platform/evaluate/evaluation.hpp"
#include "platform/evaluate/evaluation_plots.hpp"

namespace depthscope::platform {
namespace {

constexpr const char* kHelp =
    R"(depthscope evaluate - judge a run against ground truth

USAGE
  depthscope evaluate SEQUENCE_DIR RUN_DIR [--plots DIR] [--json]

SEQUENCE_DIR holds groundtruth.txt (TUM, camera to world, mm) and optionally scene.ply (the true surface),
camera.yaml and depth/NNNNNN.png (16 bit, 1/100 mm). RUN_DIR holds trajectory.txt and optionally
trajectory_live.txt and surface.ply, as `depthscope replay` writes them.

OPTIONS
  --plots DIR  draw trajectories, the distance map on the surface and its histogram as PNG files
  --json       print one JSON object instead of text

Distances are in the unit of the ground truth (mm), after alignment by a similarity (Umeyama).
)";

double maximum(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

void printJson(const Evaluation& e) {
  nlohmann::ordered_json out;
  out["frames"] = e.trajectory.frames;
  out["tracked_pct"] = e.trajectory.tracked_percent;
  out["ate_mm"] = nullptr;
  if (!e.trajectory.empty()) {
    out["ate_mm"] = e.trajectory.ate_rmse;
    out["ate_max_mm"] = maximum(e.trajectory.error);
    out["rot_deg"] = e.trajectory.rotation_rmse_deg;
    out["path_mm"] = e.trajectory.path_length;
    out["first_tracked"] =
        *std::min_element(e.trajectory.truth_index.begin(), e.trajectory.truth_index.end());
  }
  if (e.live && !e.live->empty()) out["ate_live_mm"] = e.live->ate_rmse;
  if (e.surface) {
    const SurfaceError& s = *e.surface;
    out["surface_triangles"] = s.mesh.triangles.size();
    out["surface_area_mm2"] = s.area_mm2;
    out["surface_rms_mm"] = s.statistics.rms;
    out["surface_median_mm"] = s.statistics.median;
    out["surface_p95_mm"] = s.statistics.p95;
    out["surface_over_5mm_pct"] = s.statistics.over_5mm_percent;
    for (std::size_t i = 0; s.has_completeness && i < s.complete_mm.size(); ++i)
      out["complete_" + std::to_string(static_cast<int>(s.complete_mm[i])) + "mm_pct"] =
          s.complete_percent[i];
  }
  std::puts(out.dump(2).c_str());
}

void printText(const Evaluation& e) {
  const TrajectoryError& t = e.trajectory;
  std::printf("tracked         %8.2f %%   of %zu frames\n", t.tracked_percent, t.frames);
  if (t.empty()) return (void)std::puts("ATE RMSE               -      too few poses to align");
  std::printf("ATE RMSE        %8.3f mm  max %.3f mm, rotation %.3f deg, path %.1f mm\n",
              t.ate_rmse, maximum(t.error), t.rotation_rmse_deg, t.path_length);
  if (e.live && !e.live->empty()) std::printf("ATE RMSE live   %8.3f mm\n", e.live->ate_rmse);
  if (!e.surface) return (void)std::puts("surface RMSD           -      no surface or no true one");
  const SurfaceError& s = *e.surface;
  std::printf(
      "surface RMSD    %8.3f mm  median %.3f mm, 95 %% within %.3f mm, %.2f %% over 5 mm, %zu "
      "triangles\n",
      s.statistics.rms, s.statistics.median, s.statistics.p95, s.statistics.over_5mm_percent,
      s.mesh.triangles.size());
  if (s.has_completeness)
    std::printf(
        "completeness    %8.1f %%   within 3 mm; %.1f %% within 2 mm, %.1f %% within 5 mm\n",
        s.complete_percent[1], s.complete_percent[0], s.complete_percent[2]);
}

}  // namespace

int evaluateCommand(Arguments arguments) {
  if (arguments.flag("--help")) return std::fputs(kHelp, stdout), 0;
  const bool json = arguments.flag("--json");
  const auto plots = arguments.value("--plots");
  const std::string sequence_dir = arguments.positional("SEQUENCE_DIR");
  const std::string run_dir = arguments.positional("RUN_DIR");
  arguments.finish();
  const Evaluation evaluation = evaluateRun(sequence_dir, run_dir);
  json ? printJson(evaluation) : printText(evaluation);
  if (plots) drawPlots(evaluation, *plots);
  return 0;
}

}  // namespace depthscope::platform
