// depthscope-ar, the AR process: started by depthscoped, never by hand.
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>

#include "platform/ar/ar_process.hpp"
#include "platform/log.hpp"
#include "platform/version.hpp"
#include "types/error.hpp"

namespace {

/// Dies with the video process, goes first when memory runs out, and leaves the end of the session
/// to its parent (Ctrl-C goes to the whole group).
void tieToParent() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::signal(SIGINT, SIG_IGN);
  std::ofstream("/proc/self/oom_score_adj") << 500;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace depthscope;
  using platform::LogPriority;
  platform::Arguments arguments(argc, argv);
  if (arguments.flag("--version")) return std::printf("depthscope-ar %s\n", platform::version), 0;
  if (arguments.flag("--help")) {
    std::puts(
        "depthscope-ar - tracking, mapping and reconstruction for depthscoped, which starts it by "
        "itself\n\n"
        "  depthscope-ar --shared-memory FD --commands FD --camera FILE [--config FILE]\n"
        "                [--set section.key=value]...");
    return 0;
  }
  tieToParent();
  try {
    platform::ArProcess(platform::parseArOptions(std::move(arguments))).run();
    return 0;
  } catch (const InputError& error) {
    platform::log(LogPriority::Error, "depthscope-ar cannot start", {{"error", error.what()}});
    return 2;
  } catch (const std::exception& error) {
    platform::log(LogPriority::Error, "depthscope-ar failed", {{"error", error.what()}});
    return 1;
  }
}
