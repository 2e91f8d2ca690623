#pragma once
#include <cstdint>

namespace depthscope::slam {

/// Feature extraction (slam/orb_extractor).
struct ExtractorSettings {
  int features = 1000;             // kept per frame, over all levels
  int levels = 8;                  // pyramid levels
  double scale_factor = 1.2;       // between levels
  int fast_threshold = 20;         // [grey levels], first try in each cell
  int fast_threshold_min = 7;      // [grey levels], where the first finds nothing
  int specular_threshold = 250;    // [grey levels], at or above: saturated, not tissue
  int dark_threshold = 8;          // [grey levels], at or below: outside the round field of view
};

/// Fixed capacities: what is allocated at start and never grows.
struct CapacitySettings {
  int keyframes = 256;
  int map_points = 24000;
  int observations_per_point = 48;
};

/// Everything tunable in the tracker and mapper, defaults in place. Values marked (paper) are those of
/// Chen et al. 2017, section 2, last paragraph.
struct SlamSettings {
  ExtractorSettings extractor;
  CapacitySettings capacity;
  std::int64_t trajectory_frames = 0;  // frames whose poses are kept for correctedTrajectory(); 0: none
};

}  // namespace depthscope::slam
