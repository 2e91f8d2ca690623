// Configuration keys of tracking, mapping and reconstruction.
#include "platform/config/setting_binder.hpp"

namespace depthscope::platform {
namespace {

void bindDense(SettingBinder& b, recon::DenseSettings& s) {
  b.section("recon.dense");
  b.number("pictures", s.pictures, 4, 1000, "of views, kept, 0.4 MB each");
  b.number("depth_maps", s.depth_maps, 2, 1000, "kept and fused, 0.2 MB each");
  b.number("picture_width", s.picture_width, 80, 640,
           "[px] of the undistorted view that they are matched in, at most");
  b.number("dark_threshold", s.dark_threshold, 0, 255,
           "[grey levels] at or below (in dim pictures less), joined to the border: no tissue");
  b.number("specular_threshold", s.specular_threshold, 1, 256,
           "[grey levels] at or above: a highlight");
  b.number("specular_contrast", s.specular_contrast, 1, 100,
           "times the brightness around: a highlight");
  b.number("new_depth_maps", s.new_depth_maps, 1, 100, "made for one surface at most");
  b.number("min_motion", s.min_motion, 0.001, 10,
           "distance over depth plus angle [rad] from all views that have one");
  b.number("views", s.views, 1, 10, "neighbours that a view is matched with");
  b.number("best_angle_deg", s.best_angle_deg, 1, 60,
           "between the lines of sight of view and neighbour");
  b.number("noise", s.noise, 0.1, 50, "[grey levels] texture below it does not correlate");
  b.number("step_px", s.step_px, 0.1, 2, "of disparity between hypotheses");
  b.number("smoothness_small", s.smoothness_small, 0, 1000, "P1 of semi-global matching");
  b.number("smoothness_large", s.smoothness_large, 0, 1000, "P2 of semi-global matching");
  b.number("min_correlation", s.min_correlation, 0, 1, "of windows at a depth worth keeping");
  b.number("max_error", s.max_error, 0.001, 1, "of a depth, that a pixel of disparity makes");
  b.number("agreement_views", s.agreement_views, 1, 20, "depth maps asked to confirm a depth");
  b.number("agreement_px", s.agreement_px, 0.1, 20, "[px of disparity] by which they may differ");
  b.number("voxel_size", s.voxel_size, 0.002, 0.2, "[median depth]");
  b.number("truncation", s.truncation, 2, 20, "[voxels] on either side of the surface");
  b.number("max_blocks", s.max_blocks, 256, 1000000, "of 4^3 voxels, 1 kB each");
  b.number("full_views", s.full_views, 1, 100, "depth maps at a place of confidence 1");
  b.number("full_scatter", s.full_scatter, 0.01, 20, "[voxels] scatter that halves it");
  b.number("min_confidence", s.min_confidence, 0, 1, "below it there is no surface");
  b.number("min_island_area", s.min_island_area, 0, 1000000,
           "[voxels^2] smaller separate pieces are dropped");
}

}  // namespace

void bindSlam(SettingBinder& b, slam::SlamSettings& s) {
  b.section("slam");
  b.text("vocabulary", s.vocabulary,
         "file made by depthscope train-vocabulary; empty: the built-in one");

  b.section("slam.extractor");
  b.number("features", s.extractor.features, 100, 10000,
           "features kept per frame, over all levels");
  b.number("features_at_most", s.extractor.features_at_most, 100, 10000,
           "where no map begins in 0.25 s or few points are found; at least features count");
  b.number("levels", s.extractor.levels, 1, 12, "pyramid levels");
  b.number("scale_factor", s.extractor.scale_factor, 1.05, 2, "between pyramid levels");
  b.number("fast_threshold", s.extractor.fast_threshold, 1, 255,
           "[grey levels] first try in each cell");
  b.number("fast_threshold_min", s.extractor.fast_threshold_min, 1, 255,
           "[grey levels] where the first finds nothing");
  b.number("keypoint_sigma_px", s.extractor.keypoint_sigma_px, 0.1, 5,
           "of a corner's place, in pixels of its pyramid level");
  b.number("specular_threshold", s.extractor.specular_threshold, 1, 256,
           "[grey levels] at or above: saturated, not tissue");
  b.number("specular_contrast", s.extractor.specular_contrast, 1, 10,
           "times the brightness of the tissue around: a highlight");
  b.number("dark_threshold", s.extractor.dark_threshold, -1, 254,
           "[grey levels] at or below (in dim pictures less): outside the round field of view");

  b.section("slam.capacity");
  b.number("keyframes", s.capacity.keyframes, 16, 4096, "keyframes the map has room for");
  b.number("map_points", s.capacity.map_points, 1000, 500000, "points the map has room for");
  b.number("observations_per_point", s.capacity.observations_per_point, 4, 64,
           "keyframes that may observe one point");
  b.number("local_points", s.capacity.local_points, 500, 100000, "points looked for in one frame");
  b.number("vocabulary_words", s.capacity.vocabulary_words, 1, 1000000,
           "words a vocabulary may have");
  b.number("views", s.capacity.views, 0, 4096,
           "frames, keyframes included, whose pictures are kept for reconstruction");

  b.section("slam.matching");
  b.number("search_region", s.matching.search_region, 0.1, 10, "factor on all search radii");
  b.number("motion_radius_px", s.matching.motion_radius_px, 1, 200,
           "around the predicted position, from the last frame");
  b.number("map_radius_px", s.matching.map_radius_px, 1, 200, "around a projected map point");
  b.number("hamming_strict", s.matching.hamming_strict, 1, 256,
           "[bits] new points, relocalization");
  b.number("hamming_loose", s.matching.hamming_loose, 1, 256, "[bits] guided by a pose");
  b.number("ratio", s.matching.ratio, 0.1, 1, "best over second best distance");

  b.section("slam.initializer");
  b.number("min_matches", s.initializer.min_matches, 8, 10000, "matches between the two views");
  b.number("search_radius_px", s.initializer.search_radius_px, 1, 2000,
           "around the feature's place in the first view");
  b.number("sigma_px", s.initializer.sigma_px, 0.1, 5, "of a corner's place on the fine levels");
  b.number("max_depth_sigma", s.initializer.max_depth_sigma, 0.01, 1,
           "of a new point's depth, relative to the depth");
  b.number("initial_parallax", s.initializer.initial_parallax, 0.1, 20,
           "factor on the parallax that max_depth_sigma takes");
  b.number("min_points", s.initializer.min_points, 8, 10000,
           "points of such depth that a map starts with");

  b.section("slam.tracker");
  b.number("view_motion", s.tracker.view_motion, 0.001, 10,
           "distance over depth plus angle [rad] from all kept views, above which a view is kept");
  b.number("min_motion_inliers", s.tracker.min_motion_inliers, 3, 10000,
           "fewer: try the reference keyframe");
  b.number("min_inliers", s.tracker.min_inliers, 3, 10000, "fewer in the local map: lost");
  b.number("min_inliers_relocalized", s.tracker.min_inliers_relocalized, 3, 10000,
           "needed to be found again");
  b.number("min_found_again", s.tracker.min_found_again, 0, 1,
           "share of the last frame's points; less: lost");
  b.number("min_found", s.tracker.min_found, 0, 1,
           "share of the points expected in the picture; less in the local map: lost");
  b.number("weak_below", s.tracker.weak_below, 0, 10000,
           "points found in the last frame: fewer, and less than half of those in view, and "
           "features_at_most are looked for");
  b.number("carry_below", s.tracker.carry_below, 0, 10000,
           "fewer points of the last frame found by descriptor: optical flow carries the others; "
           "0: never");
  b.number("flow_sigma_px", s.tracker.flow_sigma_px, 0.01, 5,
           "[px of a feature's level] error of optical flow from one picture to the next");
  b.number("local_keyframes", s.tracker.local_keyframes, 1, 1000,
           "that a frame's local map is made from");
  b.number("keyframe_ratio", s.tracker.keyframe_ratio, 0, 1,
           "new keyframe below this share of the reference's points");
  b.number("new_map_after_s", s.tracker.new_map_after_s, 0.05, 3600,
           "lost for this long, a new map is begun if one can be");

  b.section("slam.mapper");
  b.number("neighbours", s.mapper.neighbours, 1, 100, "keyframes to triangulate with");
  b.number("min_parallax_deg", s.mapper.min_parallax_deg, 0, 60,
           "rays closer than this make no point");
  b.number("expected_parallax_deg", s.mapper.expected_parallax_deg, 0, 60,
           "nor do features that would show less at the depth in the middle of what is seen");
  b.number("triangulation_chi2", s.mapper.triangulation_chi2, 0.01, 100,
           "squared reprojection error over variance");
  b.number("window_keyframes", s.mapper.window_keyframes, 2, 200,
           "free in local bundle adjustment");
  b.number("window_fixed", s.mapper.window_fixed, 0, 500, "fixed around them");
  b.number("iterations", s.mapper.iterations, 1, 100, "of local bundle adjustment");
  b.number("whole_map_every", s.mapper.whole_map_every, 0, 10000,
           "keyframes after which a map larger than the window is adjusted as a whole; 0: never");
  b.number("redundancy", s.mapper.redundancy, 0.1, 1,
           "share of points seen elsewhere that makes a keyframe redundant");
}

void bindRecon(SettingBinder& b, recon::ReconSettings& s) {
  b.section("recon");
  b.live(true);
  b.number("period_s", s.period_s, 0, 3600, "a new surface this often; 0: only on demand");
  b.live(false);
  b.choice("method", s.method, {"sparse", "dense"},
           "from map points alone, or from the pictures of keyframes");
  b.number("threads", s.threads, 1, 16, "that share the work; the surface does not depend on it");
  b.number("color_pictures", s.color_pictures, 1, 1000,
           "keyframes kept for the colour of surfaces");
  b.number("min_points", s.min_points, 10, 1000000,
           "fewer after the filters: no surface is attempted");
  b.number("max_points", s.max_points, 100, 1000000,
           "points taken in, the most observed ones first");
  b.number("max_triangles", s.max_triangles, 1000, 4000000, "above it the surface is made coarser");
  b.number("min_observations", s.min_observations, 1, 100, "keyframes that see a point");
  b.number("max_reprojection_error_px", s.max_reprojection_error_px, 0.1, 100,
           "of a point, root mean square");
  b.number("max_view_tilt_deg", s.max_view_tilt_deg, 10, 90,
           "between surface normal and line of sight");
  b.number("max_distance", s.max_distance, 2, 1000,
           "[median distance to the centre of the cloud] farther is a failed triangulation");
  b.number("spacing_neighbours", s.spacing_neighbours, 1, 50,
           "spacing: distance to this neighbour, median over the cloud");
  b.number("free_space_rays", s.free_space_rays, 0, 1000,
           "so many rays past a point condemn it; 0: off");
  b.number("free_space_margin", s.free_space_margin, 0, 1000,
           "[spacing] by which it must stand in front of them");
  b.number("free_space_radius", s.free_space_radius, 0, 100, "[spacing] around a ray");
  b.number("free_space_max_rays", s.free_space_max_rays, 1, 1000000,
           "rays tried, evenly from the cloud");
  b.number("outlier_radius", s.outlier_radius, 0.1, 100, "[spacing] of the radius filter");
  b.number("outlier_min_neighbours", s.outlier_min_neighbours, 0, 1000, "within it");
  b.number("voxel_size", s.voxel_size, 0.05, 10, "[spacing] of the voxel grid");
  b.number("mls_radius", s.mls_radius, 0.5, 50,
           "[spacing] neighbourhood of the Moving Least Squares fit");
  b.number("mls_max_residual", s.mls_max_residual, 0.5, 100,
           "[robust standard deviations] farther: outlier");
  b.number("poisson_cell", s.poisson_cell, 0.1, 10,
           "[spacing] wanted size of the finest octree cell");
  b.number("poisson_min_depth", s.poisson_min_depth, 3, 10, "of the octree");
  b.number("poisson_max_depth", s.poisson_max_depth, 3, 10, "of the octree");
  b.number("poisson_point_weight", s.poisson_point_weight, 0, 100,
           "pull of the samples on the surface (screening)");
  b.number("poisson_samples_per_node", s.poisson_samples_per_node, 1, 20, "of the octree");
  b.number("trim_distance", s.trim_distance, 0.1, 20,
           "[local spacing] from a vertex to the nearest point");
  b.number("trim_max_spacing", s.trim_max_spacing, 1, 20,
           "[spacing] upper bound on the local spacing");
  b.number("min_island_area", s.min_island_area, 0, 1000000,
           "[spacing^2] smaller separate pieces are dropped");
  b.number("full_confidence_support", s.full_confidence_support, 0.1, 1000,
           "observations near a vertex for confidence 1");
  bindDense(b, s.dense);
}

}  // namespace depthscope::platform
