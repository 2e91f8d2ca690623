#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "platform/arguments.hpp"
#include "platform/config/settings.hpp"
#include "platform/label_anchor.hpp"
#include "platform/map_scale.hpp"
#include "types/camera_model.hpp"

namespace depthscope::platform {

/// What one replay is asked to do.
struct ReplayOptions {
  std::filesystem::path input, camera_file, out;
  bool realtime = false;
  bool overlay = true;
  bool surface = true;
  std::vector<LabelRequest> labels;
  std::optional<ScaleRequest> scale;
  std::optional<std::int64_t> scale_frame;  // its picture; none: the last tracked one
  CameraModel camera;
  Settings settings;
};

/// Reads the command line and the files it names. Throws InputError.
ReplayOptions parseReplayOptions(Arguments arguments);

/// The text of `depthscope replay --help`.
extern const char* const replay_help;

}  // namespace depthscope::platform
