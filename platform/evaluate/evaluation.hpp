#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "platform/evaluate/surface_error.hpp"
#include "platform/evaluate/trajectory_error.hpp"

namespace depthscope::platform {

/// The surface of a run against the true one.
struct SurfaceError {
  SurfaceMesh mesh;                    // the run's surface in the world of the truth [mm]
  std::vector<float> vertex_distance;  // signed, of each of its vertices [mm]
  std::vector<float> distance;         // signed, of samples even over its area [mm]
  double area_mm2 = 0;
  DistanceStatistics statistics;
  bool has_completeness = false;             // there are depth maps
  std::array<double, 3> complete_percent{};  // of what was seen within `complete_mm` of the surface
  static constexpr std::array<double, 3> complete_mm{2, 3, 5};
};

/// One run judged.
struct Evaluation {
  std::vector<StampedPose> truth;
  TrajectoryError trajectory;
  std::optional<TrajectoryError> live;  // trajectory_live.txt: poses as they were when shown
  std::optional<SurfaceError> surface;  // there is a surface, a scene and an alignment
};

/// Judges `run_dir` (trajectory.txt, optionally trajectory_live.txt and surface.ply) by
/// `sequence_dir` (groundtruth.txt, optionally scene.ply [mm], depth/NNNNNN.png [16 bit, 1/100 mm
/// along z, distorted geometry] with camera.yaml). Throws InputError naming a missing or damaged
/// file.
Evaluation evaluateRun(const std::filesystem::path& sequence_dir,
                       const std::filesystem::path& run_dir);

}  // namespace depthscope::platform
