#pragma once
#include <string>
#include <vector>

#include "platform/arguments.hpp"
#include "platform/config/settings.hpp"
#include "types/camera_model.hpp"

namespace depthscope::platform {

/// What one run of the daemon is asked to do.
struct DaemonOptions {
  Settings settings;
  CameraModel camera;
  std::string config;                  // the file the settings came from, for reading it again
  std::vector<std::string> overrides;  // section.key=value, over those of the file
};

/// Reads the command line and the files it names. Throws InputError.
DaemonOptions parseDaemonOptions(Arguments arguments);

/// The file's settings with the overrides over them, checked. Throws InputError.
Settings readSettings(const std::string& config, const std::vector<std::string>& overrides);

/// The text of `depthscoped --help`.
extern const char* const daemon_help;

}  // namespace depthscope::platform
