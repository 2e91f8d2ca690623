#pragma once

namespace depthscope::recon {

/// Settings of the dense path: multi-view stereo of keyframes, fused in a volume. Lengths in the
/// scene are shares of the median depth of the map points, for a monocular map has no unit; lengths
/// in pictures are pixels of the reduced picture.
struct DenseSettings {
  // Keyframes kept. Memory: about 0.2 MB a picture of 320x240 and 0.2 MB a depth map.
  int pictures = 96;
  int depth_maps = 64;
  int picture_width = 320;          // [px] that pictures are reduced to, by a whole factor
  int dark_threshold = 24;          // [grey levels] at or below, joined to the border: no tissue
  int specular_threshold = 230;     // [grey levels] at or above: saturated
  double specular_contrast = 1.35;  // times the brightness around: a highlight

  // Which keyframes get a depth map: those whose map points few have covered, most of them first.
  int new_depth_maps = 8;     // for one surface at most: bounds its time
  int wanted_cover = 4;       // depth maps that should see a map point
  double min_novelty = 0.25;  // share of a keyframe's points that still lack them

  // Multi-view stereo.
  int views = 3;                     // neighbours that a keyframe is matched with
  double best_angle_deg = 12;        // between the lines of sight of keyframe and neighbour
  double noise = 2;                  // [grey levels] texture below it does not correlate
  double step_px = 0.5;              // of disparity between hypotheses at the finer levels
  int smoothness_small = 12;         // P1 of semi-global matching, out of a cost of 255,
  int smoothness_large = 60;         // and P2 (Hirschmueller 2008)
  double min_correlation = 0.3;      // of windows at a depth worth keeping
  double max_relative_error = 0.06;  // of a depth, that a pixel of disparity makes

  // Depth maps that confirm each other.
  int agreement_views = 5;  // neighbours asked
  double agreement_px = 1;  // [px of disparity at half size] by which they may differ

  // Volume and surface.
  double voxel_size = 0.02;     // [median depth]
  double truncation = 4;        // [voxels] on either side of the surface
  int max_blocks = 16384;       // of 4^3 voxels; 1 kB each. More needed: larger voxels
  double full_views = 4;        // depth maps at a place of confidence 1,
  double full_scatter = 1;      // [voxels] and standard deviation among so many that halves it
  double min_confidence = 0.4;  // below it there is no surface
  double min_island_area = 20;  // [voxels^2] smaller separate pieces are dropped
};

}  // namespace depthscope::recon
