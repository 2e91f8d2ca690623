#include "platform/tool/control_commands.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "platform/config/settings.hpp"
#include "platform/map_scale.hpp"
#include "platform/surface_writer.hpp"
#include "platform/tool/control_client.hpp"
#include "platform/unique_fd.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

/// Prints the help when asked for; `usage` is the rest of the command line after "depthscope ".
bool helpWanted(Arguments& arguments, const char* usage, const char* description) {
  if (!arguments.flag("--help")) return false;
  std::printf(
      "depthscope %s [--socket PATH]\n\n  %s\n  --socket PATH  the daemon's control socket "
      "(default %s)\n",
      usage, description, DaemonSettings().control_socket.c_str());
  return true;
}

std::string socketOption(Arguments& arguments) {
  return arguments.value("--socket").value_or(DaemonSettings().control_socket);
}

/// A text that fits into one line of the protocol.
std::string oneLine(std::string text) {
  if (text.empty() || text.find_first_of("\n\r") != std::string::npos)
    throw InputError("expected a text of one line");
  return text;
}

int printAnswer(const std::string& answer) {
  if (!answer.empty()) std::puts(answer.c_str());
  return 0;
}

}  // namespace

int statusCommand(Arguments arguments) {
  if (helpWanted(arguments, "status [--json]", "Says what the running daemon does.")) return 0;
  const bool json = arguments.flag("--json");
  const std::string socket = socketOption(arguments);
  arguments.finish();
  const std::string answer = controlRequest(socket, "status");
  if (json) return printAnswer(answer);
  const auto status = nlohmann::ordered_json::parse(answer);
  for (const auto& [key, value] : status.items())
    std::printf("%-22s %s\n", key.c_str(),
                value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
  return 0;
}

int reconstructCommand(Arguments arguments) {
  if (helpWanted(arguments, "reconstruct", "Asks for a new surface now.")) return 0;
  const std::string socket = socketOption(arguments);
  arguments.finish();
  return printAnswer(controlRequest(socket, "reconstruct"));
}

int overlayCommand(Arguments arguments) {
  if (helpWanted(arguments, "overlay MODE",
                 "How depth is shown: off, chromadepth or mesh; toggle: off and back."))
    return 0;
  const std::string socket = socketOption(arguments);
  const std::string mode = arguments.positional("a mode: off, chromadepth, mesh or toggle");
  arguments.finish();
  return printAnswer(controlRequest(socket, "overlay " + oneLine(mode)));
}

int labelCommand(Arguments arguments) {
  if (helpWanted(arguments, "label TEXT [--at X,Y]",
                 "Fixes TEXT to the tissue seen at pixel X,Y, by default the middle."))
    return 0;
  const std::string socket = socketOption(arguments);
  const auto at = arguments.value("--at");
  const std::string text = arguments.positional("a text");
  arguments.finish();
  return printAnswer(controlRequest(
      socket, at ? "label-at " + oneLine(*at) + " " + oneLine(text) : "label " + oneLine(text)));
}

int scaleCommand(Arguments arguments) {
  if (helpWanted(
          arguments, "scale [--diameter] [--in-snapshot] MM X1,Y1 X2,Y2",
          "Tells the scale of the map by a known length: MM lies on the tissue between two "
          "pixels,\n"
          "  both on the surface (a ruler, a target). Prints the scale and its uncertainty by\n"
          "  picking; it is kept until the map is lost, and exported files are in mm then.\n"
          "  --diameter     MM is the diameter of an instrument, picked across its shaft where it\n"
          "                 touches the tissue\n"
          "  --in-snapshot  the pixels are of the last `depthscope snapshot`, not of the picture\n"
          "                 as it is now: for a scope that moves"))
    return 0;
  const std::string socket = socketOption(arguments);
  std::string request = "scale ";
  if (arguments.flag("--in-snapshot")) request += "snapshot ";
  if (arguments.flag("--diameter")) request += "diameter ";
  const std::string mm = arguments.positional("a length in mm");
  const std::string a = arguments.positional("two points X,Y");
  const std::string b = arguments.positional("a second point X,Y");
  arguments.finish();
  const std::string picked = oneLine(mm) + " " + oneLine(a) + " " + oneLine(b);
  parseScaleRequest(picked);  // what is wrong with it is known without the daemon, too
  return printAnswer(controlRequest(socket, request + picked));
}

int snapshotCommand(Arguments arguments) {
  if (helpWanted(arguments, "snapshot",
                 "Saves the picture as it is shown and prints the file's name."))
    return 0;
  const std::string socket = socketOption(arguments);
  arguments.finish();
  return printAnswer(controlRequest(socket, "snapshot"));
}

int exportCommand(Arguments arguments) {
  if (helpWanted(
          arguments, "export FILE",
          "Saves the newest surface as PLY, OBJ or STL, by the end of the file's name: in mm\n"
          "  where the scale of its map is known (depthscope scale), else in the map's unit."))
    return 0;
  const std::string socket = socketOption(arguments);
  const std::filesystem::path file = arguments.positional("a file name");
  arguments.finish();
  const std::string extension = file.extension().string();
  const std::string format = extension.empty() ? "" : extension.substr(1);
  if (!surfaceFormat(format))
    throw InputError(file.string() + ": expected a name that ends in .ply, .obj or .stl");
  // The file is opened here, with the user's rights, and handed over; a daemon that refuses leaves
  // nothing.
  std::filesystem::path partial = file;
  partial += ".partial";
  const UniqueFd fd(::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (!fd.valid())
    throw InputError(file.string() +
                     ": cannot be written: " + std::generic_category().message(errno));
  try {
    const std::string answer = controlRequest(socket, "export " + format, fd.get());
    std::filesystem::rename(partial, file);
    return printAnswer(answer);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw;
  }
}

int resetCommand(Arguments arguments) {
  if (helpWanted(arguments, "reset", "Forgets map, surface, scale and labels and starts over."))
    return 0;
  const std::string socket = socketOption(arguments);
  arguments.finish();
  return printAnswer(controlRequest(socket, "reset"));
}

}  // namespace depthscope::platform
