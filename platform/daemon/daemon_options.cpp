#include "platform/daemon/daemon_options.hpp"

#include <filesystem>

#include "platform/camera_file.hpp"
#include "platform/config/config_file.hpp"
#include "platform/daemon/open_source.hpp"
#include "types/error.hpp"

namespace depthscope::platform {

const char* const daemon_help =
    R"(depthscoped - the picture from tower to monitor, with depth cues drawn over it

SYNOPSIS
  depthscoped --config FILE [--set section.key=value]...
  depthscoped --check FILE | --print-config | --version | --help

DESCRIPTION
  Captures pictures from a card (capture.device; "depthscope devices" lists them) or plays a clip
  (capture.input), composites and shows them; starts depthscope-ar, which tracks and reconstructs, and starts
  it again whenever it ends. The picture never waits for it. Stops on SIGTERM and SIGINT. SIGHUP makes it
  read its configuration again: what is marked live in --print-config takes effect at once, the log names
  the keys that need a restart, and a file with a mistake in it changes nothing.

OPTIONS
  --config FILE   configuration (TOML)
  --set KEY=VALUE one setting, after the configuration; may be repeated
  --check FILE    only checks a configuration: names what is wrong by file, line and key
  --print-config  prints every key with its default, meaning and range

EXIT STATUS
  0  stopped as asked, or the clip is over and capture.loop is false
  1  the program failed
  2  bad arguments or files; one line on stderr says which and what was expected
)";

Settings readSettings(const std::string& config, const std::vector<std::string>& overrides) {
  Settings settings;
  loadConfig(config, settings);
  for (const std::string& assignment : overrides) applyOverride(assignment, settings);
  try {
    checkConsistency(settings);
  } catch (const InputError& error) {
    throw InputError(config + ": " + error.what());
  }
  return settings;
}

DaemonOptions parseDaemonOptions(Arguments arguments) {
  DaemonOptions options;
  options.config = arguments.required("--config");
  options.overrides = arguments.values("--set");
  arguments.finish();
  options.settings = readSettings(options.config, options.overrides);
  const std::string& config = options.config;
  const CaptureSettings& capture = options.settings.capture;
  try {
    checkCapture(capture);
  } catch (const InputError& error) {
    throw InputError(config + ": " + error.what());
  }
  if (capture.camera.empty())
    throw InputError(config + ": capture.camera: is missing, expected a camera file");
  options.camera = loadCameraFile(capture.camera);
  if (capture.fps > 0) options.camera.fps = capture.fps;
  return options;
}

}  // namespace depthscope::platform
