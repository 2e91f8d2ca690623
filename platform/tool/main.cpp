// depthscope, the user's tool: one subcommand a job.
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "platform/arguments.hpp"
#include "platform/calibrate/calibrate_command.hpp"
#include "platform/evaluate/evaluate_command.hpp"
#include "platform/library_logs.hpp"
#include "platform/replay/replay_command.hpp"
#include "platform/tool/control_commands.hpp"
#include "platform/tool/devices_command.hpp"
#include "platform/version.hpp"
#include "platform/vocabulary/train_vocabulary_command.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

struct Command {
  std::string_view name;
  int (*run)(Arguments);
  const char* summary;
};

constexpr Command commands[] = {
    {"replay", replayCommand, "track, reconstruct and draw over a recorded clip"},
    {"evaluate", evaluateCommand, "judge a run against ground truth"},
    {"calibrate", calibrateCommand, "make a camera file from pictures of a board"},
    {"devices", devicesCommand,
     "what capture cards, monitors and pedals there are, and what would be taken"},
    {"train-vocabulary", trainVocabularyCommand, "make the words by which places are recognised"},
    {"status", statusCommand, "what the running daemon does (--json for scripts)"},
    {"reconstruct", reconstructCommand, "make a new surface now"},
    {"overlay", overlayCommand,
     "how depth is shown: off, chromadepth or mesh; toggle: off and back"},
    {"label", labelCommand, "fix a text to the tissue in the picture's middle, or at --at X,Y"},
    {"scale", scaleCommand,
     "say how long something in the picture is: what is exported is in mm then"},
    {"snapshot", snapshotCommand, "save the picture as it is shown"},
    {"export", exportCommand, "save the newest surface as PLY, OBJ or STL"},
    {"reset", resetCommand, "forget map, surface and labels and start over"},
};

void printHelp() {
  std::puts(
      "depthscope - depth cues and annotations for monocular endoscopy\n\nUSAGE\n"
      "  depthscope COMMAND [ARGUMENTS]   (depthscope COMMAND --help says more)\n\nCOMMANDS");
  for (const Command& c : commands) std::printf("  %-17s %s\n", c.name.data(), c.summary);
  std::puts(
      "\nEXIT STATUS\n  0 done; 1 the program failed; 2 bad arguments or files, one line on "
      "stderr");
}

int runTool(int argc, char** argv) {
  if (argc < 2) throw InputError("expected a command (see depthscope --help)");
  const std::string_view name = argv[1];
  if (name == "--help" || name == "-h") return printHelp(), 0;
  if (name == "--version") return std::printf("depthscope %s\n", version), 0;
  for (const Command& c : commands)
    if (c.name == name) return c.run(Arguments(argc - 1, argv + 1));
  throw InputError(std::string(name) + ": unknown command (see depthscope --help)");
}

}  // namespace
}  // namespace depthscope::platform

int main(int argc, char** argv) {
  using namespace depthscope;
  try {
    platform::silenceLibraries();
    return platform::runTool(argc, argv);
  } catch (const InputError& error) {
    std::fprintf(stderr, "depthscope: %s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fputs("depthscope: out of memory\n", stderr);
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "depthscope: %s\n", error.what());
    return 1;
  }
}
