#pragma once

namespace depthscope::recon {

/// Settings of the paper's reconstruction (Chen et al. 2017, section 3). Monocular maps have no
/// unit of length, so every length is given as a multiple of `spacing`: the median distance of the
/// points of the cloud at hand to their `spacing_neighbours`-th neighbour.
struct ReconSettings {
  double period_s = 3.0;  // a new surface this often; 0: only on demand
  int min_points = 100;   // fewer after the filters: no surface is attempted

  // Bounds on memory and time.
  int max_points = 24000;      // points taken in, the most observed ones first
  int max_triangles = 100000;  // above it the octree is made coarser by a level and solved again

  // Gate on single map points: what a tracker itself doubts is no tissue.
  int min_observations = 2;                // keyframes that see the point
  double max_reprojection_error_px = 3.0;  // root mean square
  double max_view_tilt_deg = 80.0;  // between surface normal and line of sight; a steeper point is
                                    // a bridge between a near and a far tissue, not a surface

  double max_distance =
      20.0;  // [median distance to the centre of the cloud] farther is a failed triangulation,
             // and would ruin the resolution of every tree and grid that spans the cloud

  int spacing_neighbours = 6;  // small enough to be local, large enough to see past doubled corners

  // Radius filter (paper, section 3.1): a point with few neighbours describes no surface.
  double outlier_radius = 2.5;     // [spacing]
  int outlier_min_neighbours = 6;  // within it

  double voxel_size =
      0.75;  // [spacing] voxel grid (paper, section 3.1): evens out texture-rich places

  // Moving Least Squares (paper, section 3.2): Gaussian weight, second order.
  double mls_radius =
      5.0;  // [spacing] neighbourhood, and scale of the weight exp(-(d / mls_radius)^2)
  double mls_max_residual =
      2.5;  // [robust standard deviations] farther from the fit: outlier, fit again

  // Screened Poisson (paper, section 3.3).
  double poisson_cell = 2.0;  // [spacing] wanted size of the finest octree cell
  int poisson_min_depth = 4;  // bounds on the octree depth that gives that cell
  int poisson_max_depth = 8;
  double poisson_point_weight = 4.0;  // pull of the samples on the surface (screening)
  double poisson_samples_per_node = 1.5;

  // Trim: Poisson closes every surface, so what no point supports is cut away.
  double trim_distance = 2.0;  // [local spacing] from a vertex to the nearest point
  double trim_max_spacing =
      2.0;  // [spacing] upper bound on the local spacing, so that holes stay holes
  double min_island_area = 40.0;  // [spacing^2] smaller separate pieces are dropped

  double full_confidence_support = 6.0;  // observations near a vertex that make its confidence 1
};

}  // namespace depthscope::recon
