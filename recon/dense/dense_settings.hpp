#pragma once

namespace depthscope::recon {

/// Settings of the dense path: multi-view stereo of views, fused in a volume. Lengths in the
/// scene are shares of the median depth of the map points, for a monocular map has no unit; lengths
/// in pictures are pixels of the undistorted view that they are matched in.
struct DenseSettings {
  // Views kept: keyframes and frames in between. Memory: about 0.4 MB a picture of 480x360 and
  // 0.2 MB a depth map.
  int pictures = 160;
  int depth_maps = 80;
  // [px] of the undistorted view that pictures are matched in, at most. It is drawn from pictures
  // reduced to no less than this: of those reduced to 320 the lens's edge was blurred twice, and a
  // view of 340 drawn from 640 was off by 0.83 mm instead of 0.93. From 340 to 400 and 480 a sweep
  // was complete to 75, 80 and 82 %.
  int picture_width = 480;
  int dark_threshold = 24;          // [grey levels] at or below, in dim pictures less: surroundings
  int specular_threshold = 230;     // [grey levels] at or above: saturated
  double specular_contrast = 1.35;  // times the brightness around: a highlight

  // Which views get a depth map: the farthest from all that have one first. Chosen by map points
  // that few had covered, and among keyframes alone, a sweep over smooth walls was complete to 58 %
  // instead of 75 %, for walls bear few points and where points stay in sight keyframes are rare.
  int new_depth_maps = 10;   // for one surface at most: bounds its time
  double min_motion = 0.06;  // from all views that have one: distance over depth plus angle [rad]

  // Multi-view stereo.
  int views = 3;               // neighbours that a view is matched with
  double best_angle_deg = 12;  // between the lines of sight of view and neighbour
  // [grey levels] Texture below it does not correlate. With 2 the sweep's walls, 2 to 3 grey levels
  // of texture, were found to 71 % instead of 74 %; with 0.5 nothing changed.
  double noise = 1;
  double step_px = 0.5;          // of disparity between hypotheses at the finer level
  int smoothness_small = 12;     // P1 of semi-global matching, out of a cost of 255,
  int smoothness_large = 60;     // and P2 (Hirschmueller 2008)
  double min_correlation = 0.3;  // of windows at a depth worth keeping
  // [median depth] that a pixel of disparity may make: bounds how far behind the rest tissue is
  // taken in. With 0.1 a hovering scope's surface was off by 0.86 mm instead of 0.82, with 0.07 a
  // sweep was complete to 82 % instead of 85 %.
  double max_error = 0.085;

  // Depth maps that confirm each other.
  int agreement_views = 5;  // neighbours asked
  double agreement_px = 1;  // [px of disparity at half size] by which they may differ

  // Volume and surface.
  // [median depth] With 0.02 a hovering scope's surface was off by 0.87 mm instead of 0.82 and
  // complete to 91.5 % instead of 92.4 %, for a third fewer triangles.
  double voxel_size = 0.017;
  double truncation = 4;    // [voxels] on either side of the surface
  int max_blocks = 16384;   // of 4^3 voxels; 1 kB each. More needed: larger voxels
  double full_views = 4;    // depth maps at a place of confidence 1,
  double full_scatter = 1;  // [voxels] and standard deviation among so many that halves it
  // Below it there is no surface. With 0.5 a hovering scope's surface was off by 0.76 mm instead of
  // 0.83, a sweep over smooth walls complete to 83.6 % instead of 84.6 %.
  double min_confidence = 0.42;
  // [voxels^2] Smaller separate pieces are dropped. Next to a highlight the light's mirror image,
  // far behind the tissue, may be taken for a surface: with 8 two such pieces stood 60 mm behind a
  // rendered scene (4.3 mm RMS instead of 1.9). With 64 a sweep over smooth walls was complete to
  // 84.8 % instead of 85.5 %.
  double min_island_area = 24;
};

}  // namespace depthscope::recon
