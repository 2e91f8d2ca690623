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
  std::vector<std::string> ar_arguments;  // for depthscope-ar: the same configuration again
};

/// Reads the command line and the files it names. Throws InputError.
DaemonOptions parseDaemonOptions(Arguments arguments);

/// The text of `depthscoped --help`.
extern const char* const daemon_help;

}  // namespace depthscope::platform
