#include "platform/ar/ar_options.hpp"

#include <fcntl.h>

#include <charconv>

#include "platform/camera_file.hpp"
#include "platform/config/config_file.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

UniqueFd descriptor(Arguments& arguments, const char* name) {
  const std::string text = arguments.required(name);
  int fd = -1;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), fd);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() || fd < 3 ||
      ::fcntl(fd, F_SETFD, FD_CLOEXEC) != 0)
    throw InputError(std::string(name) + " " + text +
                     ": expected an open descriptor, as depthscoped hands it over");
  return UniqueFd(fd);
}

}  // namespace

ArOptions parseArOptions(Arguments arguments) {
  ArOptions options;
  options.shared_memory = descriptor(arguments, "--shared-memory");
  options.commands = descriptor(arguments, "--commands");
  const std::string camera = arguments.required("--camera");
  const auto config = arguments.value("--config");
  const auto overrides = arguments.values("--set");
  arguments.finish();
  if (config) loadConfig(*config, options.settings);
  for (const std::string& assignment : overrides) applyOverride(assignment, options.settings);
  checkConsistency(options.settings);
  options.camera = loadCameraFile(camera);
  return options;
}

}  // namespace depthscope::platform
