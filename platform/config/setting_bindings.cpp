// The list of all configuration keys. To add one: add the field to its module's settings struct,
// and one line here.
#include "platform/config/setting_table.hpp"

namespace depthscope::platform {
namespace {

class Binder {
 public:
  /// Keys that follow belong to this section.
  void section(std::string_view name) {
    section_ = name;
    live_ = false;
  }
  /// Those that follow, up to the next section, may change while the daemon runs, or not.
  void live(bool may_change) { live_ = may_change; }

  template <class T>
  void number(std::string_view name, T& field, double min, double max, std::string_view doc) {
    table_.push_back({path(name), &field, min, max, doc, live_});
  }
  void flag(std::string_view name, bool& field, std::string_view doc) {
    table_.push_back({path(name), &field, 0, 0, doc, live_});
  }
  void text(std::string_view name, std::string& field, std::string_view doc) {
    table_.push_back({path(name), &field, 0, 0, doc, live_});
  }
  /// `names` in the order of the enumerators.
  template <class Enum>
  void choice(std::string_view name, Enum& field, std::vector<std::string_view> names,
              std::string_view doc) {
    ChoiceField choice{std::move(names), [&field] { return static_cast<std::size_t>(field); },
                       [&field](std::size_t i) { field = static_cast<Enum>(i); }};
    table_.push_back({path(name), std::move(choice), 0, 0, doc, live_});
  }
  std::vector<Setting> take() { return std::move(table_); }

 private:
  std::string path(std::string_view name) const { return section_ + "." + std::string(name); }
  std::string section_;
  bool live_ = false;
  std::vector<Setting> table_;
};

void bindCapture(Binder& b, CaptureSettings& s) {
  b.section("capture");
  b.text("device", s.card.device,
         "capture card: \"auto\", a path such as /dev/v4l/by-path/..., \"name:TEXT\" or "
         "\"bus:TEXT\" (depthscope devices lists them); empty: none, input is used");
  b.text("device_input", s.card.input, "of the card, by name or number; empty: as it is set");
  b.text("edid", s.card.edid,
         "what the card tells the tower: \"auto\" the built-in one where it has none, "
         "\"builtin\", \"none\" to leave it, or a binary file");
  b.text("pixel_format", s.card.pixel_format,
         "of the card, four characters such as \"NV12\"; \"auto\": the best it has");
  b.number("width", s.card.width, 0, 16384,
           "[px] wanted of cards that offer a choice; 0: the camera file's");
  b.number("height", s.card.height, 0, 16384, "[px] likewise");
  b.number("retry_ms", s.card.retry_ms, 10, 100,
           "pause between attempts to get a card or its signal back");
  b.number("restart_ms", s.card.restart_ms, 200, 60000,
           "no picture for so long although there is a signal: the card is opened anew");
  b.text("input", s.input, "video file or folder of images that stands for the endoscope");
  b.text("camera", s.camera, "camera file, as depthscope calibrate writes it");
  b.flag("loop", s.loop,
         "play the clip again at its end; without it the daemon ends with the clip");
  b.number("fps", s.fps, 0, 240,
           "pictures a second; 0: the camera file's, else the clip's own; the signal's where it "
           "has one");
  b.number("buffers", s.buffers, 4, 32, "pictures in the card's queue or the clip's pool");
  b.text("faults", s.faults, "fault script to act out; empty: none");
}

void bindSlam(Binder& b, slam::SlamSettings& s) {
  b.section("slam");
  b.text("vocabulary", s.vocabulary,
         "file made by depthscope train-vocabulary; empty: the built-in one");

  b.section("slam.extractor");
  b.number("features", s.extractor.features, 100, 10000,
           "features kept per frame, over all levels");
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
           "[grey levels] at or below: outside the round field of view");

  b.section("slam.capacity");
  b.number("keyframes", s.capacity.keyframes, 16, 4096, "keyframes the map has room for");
  b.number("map_points", s.capacity.map_points, 1000, 500000, "points the map has room for");
  b.number("observations_per_point", s.capacity.observations_per_point, 4, 256,
           "keyframes that may observe one point");
  b.number("local_points", s.capacity.local_points, 500, 100000, "points looked for in one frame");

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
  b.number("min_motion_inliers", s.tracker.min_motion_inliers, 3, 10000,
           "fewer: try the reference keyframe");
  b.number("min_inliers", s.tracker.min_inliers, 3, 10000, "fewer in the local map: lost");
  b.number("min_inliers_relocalized", s.tracker.min_inliers_relocalized, 3, 10000,
           "needed to be found again");
  b.number("min_found_again", s.tracker.min_found_again, 0, 1,
           "share of the last frame's points; less: lost");
  b.number("min_found", s.tracker.min_found, 0, 1,
           "share of the points expected in the picture; less in the local map: lost");
  b.number("local_keyframes", s.tracker.local_keyframes, 1, 1000,
           "that a frame's local map is made from");
  b.number("keyframe_ratio", s.tracker.keyframe_ratio, 0, 1,
           "new keyframe below this share of the reference's points");
  b.number("new_map_after_s", s.tracker.new_map_after_s, 0.05, 3600,
           "lost for this long, a new map is begun if one can be");

  b.section("slam.mapper");
  b.number("neighbours", s.mapper.neighbours, 1, 100, "keyframes to triangulate with");
  b.number("max_parallax_cos", s.mapper.max_parallax_cos, 0.5, 1,
           "rays closer than this make no point");
  b.number("triangulation_chi2", s.mapper.triangulation_chi2, 0.01, 100,
           "squared reprojection error over variance");
  b.number("window_keyframes", s.mapper.window_keyframes, 2, 200,
           "free in local bundle adjustment");
  b.number("window_fixed", s.mapper.window_fixed, 0, 500, "fixed around them");
  b.number("iterations", s.mapper.iterations, 1, 100, "of local bundle adjustment");
  b.number("redundancy", s.mapper.redundancy, 0.1, 1,
           "share of points seen elsewhere that makes a keyframe redundant");
}

void bindRecon(Binder& b, recon::ReconSettings& s) {
  b.section("recon");
  b.live(true);
  b.number("period_s", s.period_s, 0, 3600, "a new surface this often; 0: only on demand");
  b.live(false);
  b.choice("method", s.method, {"sparse", "dense"},
           "from map points alone, or from the pictures of keyframes");
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
}

void bindDense(Binder& b, recon::DenseSettings& s) {
  b.section("recon.dense");
  b.number("pictures", s.pictures, 4, 1000, "keyframe pictures kept, 0.2 MB each");
  b.number("depth_maps", s.depth_maps, 2, 1000, "kept and fused, 0.2 MB each");
  b.number("picture_width", s.picture_width, 80, 640, "[px] that pictures are reduced to");
  b.number("dark_threshold", s.dark_threshold, 0, 255,
           "[grey levels] at or below, joined to the border: no tissue");
  b.number("specular_threshold", s.specular_threshold, 1, 256,
           "[grey levels] at or above: a highlight");
  b.number("specular_contrast", s.specular_contrast, 1, 100,
           "times the brightness around: a highlight");
  b.number("new_depth_maps", s.new_depth_maps, 1, 100, "made for one surface at most");
  b.number("wanted_cover", s.wanted_cover, 1, 100, "depth maps that should see a map point");
  b.number("min_novelty", s.min_novelty, 0.01, 1,
           "share of a keyframe's points that lack them, for it to get one");
  b.number("views", s.views, 1, 10, "neighbours that a keyframe is matched with");
  b.number("best_angle_deg", s.best_angle_deg, 1, 60,
           "between the lines of sight of keyframe and neighbour");
  b.number("noise", s.noise, 0.1, 50, "[grey levels] texture below it does not correlate");
  b.number("step_px", s.step_px, 0.1, 2, "of disparity between hypotheses");
  b.number("smoothness_small", s.smoothness_small, 0, 1000, "P1 of semi-global matching");
  b.number("smoothness_large", s.smoothness_large, 0, 1000, "P2 of semi-global matching");
  b.number("min_correlation", s.min_correlation, 0, 1, "of windows at a depth worth keeping");
  b.number("max_relative_error", s.max_relative_error, 0.001, 1,
           "of a depth, that a pixel of disparity makes");
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

void bindOverlay(Binder& b, overlay::OverlaySettings& s) {
  b.section("overlay");
  b.live(true);
  b.choice("cue", s.cue, {"off", "chromadepth", "mesh"}, "how depth is shown");
  b.number("opacity", s.opacity, 0, 1, "of the cue over the picture");
  b.flag("inset", s.inset, "the turned-aside view of the mesh in a corner");
  b.flag("labels", s.labels, "show labels");
  b.number("gone_confidence", s.gone_confidence, 0, 1,
           "of the pose, at or below which nothing is drawn over the picture");
  b.number("full_confidence", s.full_confidence, 0, 1,
           "of the pose, from which the overlay has its whole strength");
  b.number("crossfade_s", s.crossfade_s, 0, 10, "from one surface to the next");
  b.number("border_fade", s.border_fade, 0, 0.5, "width of the surface's soft border, of the mesh");
  b.number("inset_turn_deg", s.inset_turn_deg, -89, 89,
           "of the turned-aside view, about the picture's vertical axis");
  b.number("inset_width", s.inset_width, 0.05, 0.5, "of the picture's width");
  b.live(false);
  b.number("max_age_ms", s.max_age_ms, 10, 1000,
           "an overlay older than this is gone; it fades before");
  b.number("label_height_px", s.label_height_px, 0, 400,
           "of the text; 0: from the picture's height");
  b.text("font_file", s.font_file, "TrueType file; empty: DejaVu Sans where Debian puts it");
  b.number("max_triangles", s.max_triangles, 1000, 1000000,
           "drawn of a surface; one of more is made coarser first");
  b.number("max_labels", s.max_labels, 0, 256,
           "memory is set aside for so many; later ones are left out");
}

void bindDisplay(Binder& b, DisplaySettings& s) {
  b.section("display");
  b.choice(
      "kind", s.kind, {"null", "file", "kms", "fbdev"},
      "where the pictures go: nowhere, into a video file, to a monitor, to a bare framebuffer");
  b.text("path", s.path, "video file to write, for kind \"file\"");
  b.text("device", s.device,
         "for \"kms\" the card, e.g. /dev/dri/card0, \"auto\": the first with a monitor; for "
         "\"fbdev\" "
         "the framebuffer, \"auto\": /dev/fb0");
  b.text("connector", s.connector,
         "for \"kms\": the card's connector, e.g. HDMI-A-1; \"auto\": the first with a monitor");
  b.choice(
      "route", s.route, {"auto", "gpu", "cpu"},
      "for \"kms\": what lays the overlay over the picture; \"auto\": the display's own planes, "
      "with no driver of a graphics processor in the picture's way, else the processor; "
      "\"gpu\": the graphics processor, else the processor");
  b.text("mode", s.mode,
         "for \"kms\": WIDTHxHEIGHT or WIDTHxHEIGHT@HZ; \"auto\": the picture's own size and rate "
         "where the monitor has it");
  b.choice("registration", s.registration, {"lowest-latency", "exact"},
           "\"lowest-latency\" shows the picture at once, with the newest pose carried on to its "
           "time; \"exact\" lets it wait for the pose that is found in it");
  b.number("exact_wait", s.exact_wait, 0.1, 0.9,
           "[frame intervals] most that a picture waits for that");
}

void bindFootswitch(Binder& b, FootswitchSettings& s) {
  b.section("footswitch");
  b.live(true);
  b.choice("action", s.action, {"reconstruct", "overlay-toggle", "snapshot"},
           "what a press of the pedal does");
  b.live(false);
  b.text("line", s.line,
         "GPIO line of a pedal, by name or, with a chip, by its offset; empty: none");
  b.text("chip", s.chip,
         "GPIO chip by path, name or label; empty: the line is looked for by name on all");
  b.choice("bias", s.bias, {"as-is", "disabled", "pull-up", "pull-down"},
           "resistor on the line, where the chip has one");
  b.flag("active_low", s.active_low, "the pedal pulls the line low");
  b.number("debounce_ms", s.debounce_ms, 0, 1000,
           "a level counts once it was steady for so long; by the kernel where it can");
  b.text("keyboard", s.keyboard,
         "USB pedal that is a keyboard, by path under /dev/input or name; empty: none");
  b.number("key", s.key, 0, 767, "its key, by number in linux/input-event-codes.h; 0: any");
}

void bindHeartbeat(Binder& b, HeartbeatSettings& s) {
  b.section("heartbeat");
  b.text("line", s.line,
         "GPIO line that changes its level, 20 times a second at most, only while pictures go out, "
         "for a relay that bypasses the box; by name or, with a chip, by its offset; empty: none");
  b.text("chip", s.chip,
         "GPIO chip by path, name or label; empty: the line is looked for by name on all");
  b.flag("active_low", s.active_low, "the line starts high");
}

void bindDaemon(Binder& b, DaemonSettings& s) {
  b.section("daemon");
  b.text("control_socket", s.control_socket, "where depthscope status and the like connect to");
  b.text("state_dir", s.state_dir, "folder for snapshots");
  b.text("ar_program", s.ar_program, "the AR process; empty: depthscope-ar beside depthscoped");
  b.number("realtime_priority", s.realtime_priority, 0, 99,
           "SCHED_FIFO priority of the video loop; 0: ordinary");
  b.flag("lock_memory", s.lock_memory, "keep all pages of the video process in memory");
  b.number("restart_min_s", s.restart_min_s, 0.01, 60,
           "first wait before the AR process is started again");
  b.number("restart_max_s", s.restart_max_s, 0.01, 600, "the wait doubles up to this");
  b.number("heartbeat_timeout_s", s.heartbeat_timeout_s, 0.5, 600,
           "an AR process silent for longer is killed and started again");
  b.number("ar_nice", s.ar_nice, 0, 19, "the AR process gives way to the picture: nice(2) value");
  b.number("ar_memory_mb", s.ar_memory_mb, 0, 1 << 20,
           "[MiB] private memory the AR process may take; 0: no limit");
  b.number("overlay_wait", s.overlay_wait, 0, 1,
           "[frame intervals] most that a picture waits for its overlay");
  b.number("stale_s", s.stale_s, 0, 60,
           "[s] the last picture stays for so long, marked, when no new one comes");
  b.text("frame_log", s.frame_log, "CSV file with the times of every picture; empty: none");
  b.number("max_vertices", s.max_vertices, 1000, 4000000, "room for a surface in shared memory");
  b.number("max_triangles", s.max_triangles, 1000, 8000000, "room for a surface in shared memory");
}

}  // namespace

std::vector<Setting> settingTable(Settings& settings) {
  Binder binder;
  bindCapture(binder, settings.capture);
  bindSlam(binder, settings.slam);
  bindRecon(binder, settings.recon);
  bindDense(binder, settings.recon.dense);
  bindOverlay(binder, settings.overlay);
  bindDisplay(binder, settings.display);
  bindFootswitch(binder, settings.footswitch);
  bindHeartbeat(binder, settings.heartbeat);
  bindDaemon(binder, settings.daemon);
  return binder.take();
}

}  // namespace depthscope::platform
