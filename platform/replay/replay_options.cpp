#include "platform/replay/replay_options.hpp"

#include <charconv>

#include "platform/camera_file.hpp"
#include "platform/config/config_file.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

void readScale(Arguments& arguments, ReplayOptions& options) {
  if (const auto text = arguments.value("--scale")) options.scale = parseScaleRequest(*text);
  const auto frame = arguments.value("--scale-frame");
  if (options.scale && !options.surface)
    throw InputError("--scale: needs a surface, expected no --no-surface");
  if (!frame) return;
  std::int64_t number = -1;
  const auto [end, error] = std::from_chars(frame->data(), frame->data() + frame->size(), number);
  if (error != std::errc() || end != frame->data() + frame->size() || number < 0)
    throw InputError("--scale-frame " + *frame + ": expected the number of a frame, from 0");
  if (!options.scale) throw InputError("--scale-frame: expected --scale with it");
  options.scale_frame = number;
}

}  // namespace

const char* const replay_help =
    R"(depthscope replay - track, reconstruct and draw over a recorded clip

SYNOPSIS
  depthscope replay --input PATH --camera FILE --out DIR [--config FILE] [--set section.key=value]...
                    [--realtime] [--no-overlay] [--no-surface] [--label TEXT@X,Y]...
                    [--scale "MM X1,Y1 X2,Y2" [--scale-frame N]]

DESCRIPTION
  Runs the box's main job on a clip. Without --realtime every frame is tracked in lockstep, nothing is
  dropped, and two runs give the same trajectory and surface byte for byte. Frame i has the time i / fps.

OPTIONS
  --input PATH      video file, or folder of images in the order of their names
  --camera FILE     camera file (OpenCV YAML), as depthscope calibrate writes it
  --out DIR         folder for the results; made where missing, written only when the clip is through
  --config FILE     configuration (TOML); depthscoped --print-config prints every key
  --set KEY=VALUE   one setting, after the configuration; may be repeated
  --realtime        play at the clip's rate, as the daemon would, and drop frames when late
  --no-overlay      write no overlay.mp4 and no snapshot.png
  --no-surface      reconstruct nothing, write no surface.ply
  --label TEXT@X,Y  anchor TEXT on the tissue seen at pixel X,Y when the first surface is there; may be repeated
  --scale "MM X1,Y1 X2,Y2"
                    the length MM lies on the tissue between these pixels of the last tracked picture
                    (snapshot.png) or of frame N (--scale-frame, from 0); "diameter MM X1,Y1 X2,Y2": MM is
                    the diameter of an instrument, picked across its shaft where it touches the tissue.
                    Measured at the end on the last surface: mm_per_unit in metrics.json (null, and a
                    warning, where it cannot be measured) and in the header of surface.ply

FILES in DIR
  trajectory.txt       TUM format, camera to world, corrected by everything learnt until the end; where
                       tissue is found to breathe steadily (tissue_rhythm_hz in metrics.json), with
                       what its change of shape did to the poses taken back
  trajectory_live.txt  the same, each pose as it was when its frame was shown
  map.ply surface.ply  sparse points and the last surface, in the trajectory's world frame and unit of length
  overlay.mp4          the composited picture; snapshot.png: the last tracked one
  metrics.json         counts, times and memory

EXIT STATUS
  0  the clip was processed to its end, tracked or not
  1  the program failed
  2  bad arguments or files; one line on stderr says which and what was expected
)";

ReplayOptions parseReplayOptions(Arguments arguments) {
  ReplayOptions options;
  options.input = arguments.required("--input");
  options.camera_file = arguments.required("--camera");
  options.out = arguments.required("--out");
  options.realtime = arguments.flag("--realtime");
  options.overlay = !arguments.flag("--no-overlay");
  options.surface = !arguments.flag("--no-surface");
  readScale(arguments, options);
  const auto config = arguments.value("--config");
  const auto overrides = arguments.values("--set");
  for (const std::string& label : arguments.values("--label"))
    options.labels.push_back(parseLabelRequest(label));
  arguments.finish();
  if (config) loadConfig(*config, options.settings);
  for (const std::string& assignment : overrides) applyOverride(assignment, options.settings);
  checkConsistency(options.settings);
  options.camera = loadCameraFile(options.camera_file);
  if (options.scale) requireInPicture(*options.scale, options.camera);
  return options;
}

}  // namespace depthscope::platform
