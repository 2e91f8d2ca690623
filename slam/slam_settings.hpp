#pragma once
#include <algorithm>
#include <cstdint>
#include <string>

namespace depthscope::slam {

/// Feature extraction (slam/orb_extractor).
struct ExtractorSettings {
  int features = 1000;  // kept per frame, over all levels
  // Where no map begins, and where few points are found (TrackerSettings::weak_below).
  int features_at_most = 2000;
  int levels = 8;             // pyramid levels
  double scale_factor = 1.2;  // between levels
  // FAST thresholds on pictures smoothed by a Gaussian of sigma 0.7, which takes half of a corner's
  // contrast. Where a whole picture has less than `features` corners both are halved, twice at
  // most: with one halving 82 % of the frames were tracked on dark, smooth tissue (two clips, each
  // also backwards), with two 91 %.
  int fast_threshold = 10;     // [grey levels], first try in each cell
  int fast_threshold_min = 6;  // [grey levels], where the first finds nothing
  // Standard deviation of a corner's place [px of its pyramid level], which all gates on
  // reprojection errors rest on. Measured after bundle adjustment, each axis: 0.36 on rendered
  // tissue, 0.44 where it breathes, 0.44 to 0.55 hand-held; the same on all levels. With 1
  // (Mur-Artal et al.) gates let in what is six times too far off: on a hovering scope the path's
  // error was 0.24 mm, live 0.28; with 0.7 it was 0.16 and 0.19, and with 0.35 the same, for twice
  // the keyframes.
  double keypoint_sigma_px = 0.7;
  // Luma of towers is mostly 16..235 (BT.601 and 709), and comes as it is.
  int specular_threshold = 230;     // [grey levels], at or above: saturated, not tissue
  double specular_contrast = 1.35;  // times the brightness of the tissue around: a highlight
  // At or below, and in dim pictures less (types/surroundings.hpp): outside the round field of
  // view. Fixed, with a third of the light a hovering scope was lost seven times and off by 9 mm;
  // now it is not lost and off by 0.25 mm.
  int dark_threshold = 24;  // [grey levels]

  /// Features of a frame, of whichever kind.
  int capacity() const { return std::max(features, features_at_most); }
};

/// Fixed capacities: what is allocated at start and never grows.
struct CapacitySettings {
  int keyframes = 256;
  int map_points = 24000;
  int observations_per_point = 48;  // keyframes that may observe one point, 64 at most
  int local_points = 6000;          // points the tracker looks for in one frame
  int vocabulary_words = 16384;     // the built-in vocabulary has about 10000
  int views = 128;                  // whose pictures reconstruction keeps
};

/// Descriptor matching (slam/matcher). Hamming distances are out of 256 bits, radii at level 0.
struct MatchingSettings {
  // Factor on all search radii; 1.5 (paper). With 1.5 a sweep was off by 0.671 mm instead of 0.656,
  // nasal endoscopy by 0.0140 instead of 0.0080; hovering and hand-held paths were as good (means
  // of five runs each).
  double search_region = 1.0;
  double motion_radius_px = 15;  // around the position predicted from the last frame
  double map_radius_px = 4;      // around a projected map point
  // With the paper's values the second of two clips of dark, smooth tissue was lost once (88 % of
  // the frames tracked instead of 97), a hovering scope was off by 0.22 mm instead of 0.13, nasal
  // endoscopy live by 0.0203 instead of 0.0116.
  int hamming_strict = 50;  // new points; 0.8 * 50 = 40 (paper)
  int hamming_loose = 100;  // guided by a pose; 0.8 * 100 = 80 (paper)
  double ratio = 0.9;       // best over second best, same level
};

/// Two-view initialization (slam/map_initializer).
struct InitializerSettings {
  int min_matches = 60;           // between the two pictures
  double search_radius_px = 100;  // around the feature's position in the first picture
  double sigma_px = 0.6;          // of a corner's place on the fine levels, which alone are matched
  // A start by accuracy of depth, not by a fixed median angle of 1 degree: hand-held from frame 19
  // instead of 34, nasal endoscopy from 1 instead of 3, noisy and recompressed from 4 instead
  // of 75.
  double max_depth_sigma = 0.2;  // of a point, relative: sqrt(2) sigma / (focal length * parallax)
  // Factor on the parallax that this takes; 5 (paper). With 5 nasal endoscopy was tracked in 71 %
  // of 35 frames instead of 97, a hand-held camera from frame 36 instead of 17, and a sweep was off
  // by 0.690 mm instead of 0.656.
  double initial_parallax = 1.0;
  int min_points = 60;  // with such a depth, that a map is started with
};

/// Tracking (slam/tracker).
struct TrackerSettings {
  int min_motion_inliers = 10;  // fewer from the last frame: try the reference keyframe
  int min_inliers = 30;         // fewer in the local map: lost
  // Fewer after relocalization: not found, nor with fewer than eight times as many as match by
  // chance. Right poses rested on 26 and more; in 1200 pictures of places never seen (four clips
  // that go on mirrored) none was accepted.
  int min_inliers_relocalized = 20;
  // Of the points of the last frame, the share found again: a few percent match by chance where the
  // pose is wrong (after a cut, in heavy blur), a third and more where it is right.
  double min_found_again = 0.1;
  // The same of all points expected in the picture, or of its features where they are fewer: 3 to
  // 8 % by chance, mostly above 10 % where the pose is right.
  double min_found = 0.05;
  // Lost for this long, a new map is begun if one can be, while the old ones are looked for all the
  // same. Time for every keyframe to have its turn in relocalization: of 120 at 30 pictures a
  // second.
  double new_map_after_s = 0.5;
  int local_keyframes = 40;  // that a frame's local map is made from
  // Points found in the last frame: fewer than these and than half of those in view, and
  // features_at_most are looked for. Without it two clips of dark, smooth tissue were lost once
  // each and tracked in 92 and 93 % of the frames, with it in 97 and 97 %, never lost. Twice the
  // features everywhere take half as long again.
  int weak_below = 250;
  // Of the points of the last frame found by descriptor: fewer, and optical flow carries the
  // others, each step with an error of its own [px of the feature's level]. Without it two clips of
  // dark, smooth tissue were lost once each and tracked in 92 and 93 % of the frames, with it in 97
  // and 97 %, never lost. Where there is texture it has nothing to do.
  int carry_below = 90;
  double flow_sigma_px = 0.3;
  // Of the reference keyframe's points tracked: below, a new one. With 0.8 there are 1.5 to 2 times
  // as many keyframes and no better paths; with 0.6 hand-held paths got worse.
  double keyframe_ratio = 0.65;
  // Distance over depth plus angle [rad] from all views whose pictures are kept, above which a
  // frame's is kept, too.
  double view_motion = 0.06;
};

/// Mapping (slam/mapper).
struct MapperSettings {
  int neighbours = 10;  // keyframes to triangulate with
  // Rays closer than this make no point. With 1.15 deg there were fewer, and the second of two
  // clips of dark, smooth tissue was lost once (93 % of the frames tracked instead of 97); nasal
  // endoscopy (eight pieces), a sweep and a hand-held path were as good (means of five runs each).
  double min_parallax_deg = 0.57;
  // Nor do features whose parallax would be smaller than this at the depth in the middle of what
  // the keyframe sees. Where a baseline is that short the gate above is passed by what noise has
  // brought near, and the map shrinks as it grows. Two clips of dark, smooth tissue played forwards
  // and backwards: within a second depth changed by factors that differed by 1.3 instead of 1.6 on
  // one, by 1.6 with it and without on the other.
  double expected_parallax_deg = 0.8;
  // Squared error over variance of a new point; 0.5991 (paper), which leaves up to 23 % fewer
  // points. With it a sweep was off by 0.655 mm instead of 0.656, live by 0.669 instead of 0.650,
  // a hand-held path was as good, and the second of two clips of dark, smooth tissue was lost once
  // (92 % of the frames tracked instead of 97).
  double triangulation_chi2 = 5.991;
  // With 15 and 20 (same start) the hovering path was off by 0.16 mm instead of 0.10, live 0.19
  // instead of 0.16; mapping a keyframe took 34 ms of processor time instead of 52.
  int window_keyframes = 30;  // free in local bundle adjustment
  int window_fixed = 40;      // fixed around them
  int iterations = 12;        // of local bundle adjustment
  // Keyframes after which a map larger than the window is adjusted as a whole, in the background;
  // 0: only after a loop or a merger. Without it a hovering scope's map bent where it came back to
  // what it had seen before: all points together fitted worse by 30 %, rays turned by 2.5e-5 rad a
  // millimetre of the path, and its surface lay 1 mm too far at 150 mm.
  int whole_map_every = 5;
  double redundancy = 0.9;  // share of points seen elsewhere: above, a keyframe goes
};

/// Everything tunable in the tracker and mapper, defaults in place. Values marked (paper) are those
/// of Chen et al. 2017, section 2, last paragraph.
struct SlamSettings {
  ExtractorSettings extractor;
  CapacitySettings capacity;
  MatchingSettings matching;
  InitializerSettings initializer;
  TrackerSettings tracker;
  MapperSettings mapper;
  std::string vocabulary;  // file made by depthscope train-vocabulary; empty: the built-in one
  std::int64_t trajectory_frames = 0;  // last poses kept for correctedTrajectory(); 0: none
};

}  // namespace depthscope::slam
