// depthscoped, the video process.
#include <cstdio>
#include <exception>

#include "platform/camera_file.hpp"
#include "platform/config/config_file.hpp"
#include "platform/daemon/daemon.hpp"
#include "platform/daemon/open_source.hpp"
#include "platform/library_logs.hpp"
#include "platform/version.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

int checkConfig(const std::string& file) {
  Settings settings;
  loadConfig(file, settings);
  try {
    checkConsistency(settings);
    checkCapture(settings.capture);
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what());
  }
  if (!settings.capture.camera.empty()) loadCameraFile(settings.capture.camera);
  std::printf("%s: ok\n", file.c_str());
  return 0;
}

int runDaemon(Arguments arguments) {
  if (arguments.flag("--help")) return std::fputs(daemon_help, stdout), 0;
  if (arguments.flag("--version")) return std::printf("depthscoped %s\n", version), 0;
  if (arguments.flag("--print-config")) return std::fputs(documentedConfig().c_str(), stdout), 0;
  if (const auto file = arguments.value("--check")) {
    arguments.finish();
    return checkConfig(*file);
  }
  silenceLibraries();
  Daemon(parseDaemonOptions(std::move(arguments))).run();
  return 0;
}

}  // namespace
}  // namespace depthscope::platform

int main(int argc, char** argv) {
  using namespace depthscope;
  try {
    return platform::runDaemon(platform::Arguments(argc, argv));
  } catch (const InputError& error) {
    std::fprintf(stderr, "depthscoped: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "depthscoped: %s\n", error.what());
    return 1;
  }
}
