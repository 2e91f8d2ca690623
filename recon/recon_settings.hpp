#pragma once
#include "recon/dense/dense_settings.hpp"

namespace depthscope::recon {

/// Settings of reconstruction: what is common, those of the dense path in `dense`, the others of
/// the paper's (Chen et al. 2017, section 3). Monocular maps have no unit of length, so every
/// length of the paper's path is given as a multiple of `spacing`: the median distance of the
/// points of the cloud at hand to their `spacing_neighbours`-th neighbour.
struct ReconSettings {
  enum class Method { Sparse, Dense };  // from map points alone (paper) or pictures
  Method method = Method::Dense;
  DenseSettings dense;
  int threads = 2;  // that share the work; the surface does not depend on how many
  // A new surface this often; 0: only on demand. Each makes depth maps of what came into view: with
  // 3 s a sweep of 15 s was complete to 83 % instead of 85 %.
  double period_s = 2.0;
  int color_pictures = 128;  // views whose colour is kept, 58 kB each at 640x480: 7 MB
  int min_points = 100;      // fewer after the filters: no surface is attempted

  // Bounds on memory and time.
  int max_points = 10000;      // points taken in, the most observed ones first
  int max_triangles = 100000;  // above it the surface is made coarser

  // Gate on single map points: what a tracker itself doubts is no tissue.
  int min_observations = 2;                // keyframes that see the point
  double max_reprojection_error_px = 3.0;  // root mean square
  // A point much farther from the centre of the cloud than others [median distance to it] is a
  // failed triangulation, and would ruin the resolution of every tree and grid over the cloud.
  double max_distance = 20.0;

  int spacing_neighbours = 6;  // small enough to be local, large enough to see past doubled corners

  // Free space: a point in the line of sight of others floats, for they were seen past it.
  int free_space_rays = 5;         // so many rays past a point condemn it; 0: off
  double free_space_margin = 4.0;  // [spacing] by which it must stand in front of them
  double free_space_radius = 1.0;  // [spacing] around a ray
  int free_space_max_rays = 3000;  // evenly from the cloud; the radius grows where not all are

  // Radius filter (paper, section 3.1): a point with few neighbours describes no surface.
  double outlier_radius = 2.5;     // [spacing]
  int outlier_min_neighbours = 6;  // within it

  // Voxel grid (paper, section 3.1): evens out places rich in texture.
  double voxel_size = 0.75;  // [spacing]

  // Moving Least Squares (paper, section 3.2): second order, weight exp(-(d / mls_radius)^2).
  double mls_radius = 3.0;          // [spacing]
  double mls_max_residual = 2.5;    // [robust standard deviations] farther: outlier, fit again
  double max_view_tilt_deg = 80.0;  // of the normal; steeper is a bridge from near to far tissue

  // Screened Poisson (paper, section 3.3).
  double poisson_cell = 2.0;  // [spacing] wanted size of the finest octree cell,
  int poisson_min_depth = 4;  // within these bounds on the depth of the octree
  int poisson_max_depth = 8;
  double poisson_point_weight = 8.0;      // pull of the points on the surface (screening)
  double poisson_samples_per_node = 1.5;  // points a cell needs to be split

  // Trim: Poisson closes every surface, so what no point supports is cut away.
  double trim_distance = 1.5;     // [local spacing] from a vertex to the nearest point
  double trim_max_spacing = 1.5;  // [spacing] bound on the local spacing: holes stay holes
  double min_island_area = 40.0;  // [spacing^2] smaller separate pieces are dropped

  double full_confidence_support = 6.0;  // observations around a vertex of confidence 1
};

}  // namespace depthscope::recon
