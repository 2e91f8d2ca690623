#include "platform/tool/devices_command.hpp"

#include <cstdio>
#include <iostream>

#include "platform/camera_file.hpp"
#include "platform/config/config_file.hpp"
#include "platform/daemon/open_source.hpp"
#include "platform/footswitch/keyboard_pedal.hpp"
#include "platform/tool/list_displays.hpp"

namespace depthscope::platform {
namespace {

constexpr const char* help =
    R"(depthscope devices [--config FILE] [--set section.key=value]...

  Lists the capture cards that are there, their inputs, signals and pixel formats, and which of them
  the daemon would take: with --config as capture.device says, without it as "auto" would. A card is
  named in the configuration by its path, a link to it, name:TEXT or bus:TEXT. Then the graphics
  cards with their connectors and modes, and the one that would be lit; and what a pedal can be:
  keyboards and GPIO lines with a name. Changes nothing.
)";

void printFormat(std::ostream& out, const capture::CaptureFormat& format) {
  out << "    " << format.fourcc << (format.usable ? "  " : "  (not usable) ") << format.description
      << '\n';
  for (const std::string& size : format.sizes) out << "          " << size << '\n';
}

void printDevice(std::ostream& out, const capture::CaptureDevice& device) {
  out << device.path;
  if (!device.error.empty()) {
    out << ": " << device.error << "\n\n";
    return;
  }
  out << "  " << device.card << '\n'
      << "  driver    " << device.driver << (device.multiplanar ? " (multi-planar)" : "") << '\n'
      << "  bus       " << device.bus << '\n';
  for (const std::string& link : device.links) out << "  link      " << link << '\n';
  for (const capture::CaptureInput& input : device.inputs)
    out << "  input     " << input.index << " \"" << input.name << "\": " << input.state
        << (input.current ? " (is set)" : "") << '\n';
  if (!device.signal.empty()) out << "  signal    " << device.signal << '\n';
  if (device.has_edid) out << "  EDID      can be set\n";
  out << "  formats\n";
  for (const capture::CaptureFormat& format : device.formats) printFormat(out, format);
  out << '\n';
}

void printChoice(std::ostream& out, const capture::CaptureChoice& choice,
                 const std::string& selection) {
  out << "capture.device = \"" << selection << "\": ";
  if (choice.path.empty()) {
    out << choice.reason << '\n';
    return;
  }
  out << choice.path;
  if (!choice.input.empty()) out << ", input \"" << choice.input << '"';
  if (!choice.format.empty()) out << ", " << choice.format;
  if (!choice.reason.empty()) out << " (" << choice.reason << ')';
  out << '\n';
}

}  // namespace

void printDevices(std::ostream& out, kernel::SystemCalls& calls,
                  const capture::V4l2Settings& settings) {
  const auto devices = capture::listCaptureDevices(calls);
  for (const capture::CaptureDevice& device : devices) printDevice(out, device);
  if (devices.empty()) out << "no capture device found\n";
  if (!settings.device.empty() && !devices.empty())
    printChoice(out, chooseCapture(calls, settings), settings.device);
}

void printPedals(std::ostream& out, kernel::SystemCalls& calls, GpioChips& chips) {
  for (const InputDevice& keyboard : listKeyboards(calls))
    out << "keyboard  " << keyboard.path << "  " << keyboard.name << '\n';
  for (const GpioLineInfo& line : chips.list())
    if (!line.name.empty())
      out << "GPIO line " << line.name << ": " << line.chip << " offset " << line.offset
          << (line.used ? " (in use)" : "") << '\n';
}

int devicesCommand(Arguments arguments) {
  if (arguments.flag("--help")) return std::fputs(help, stdout), 0;
  const auto config = arguments.value("--config");
  const auto overrides = arguments.values("--set");
  arguments.finish();
  Settings settings;
  if (config) loadConfig(*config, settings);
  for (const std::string& assignment : overrides) applyOverride(assignment, settings);
  if (!config && settings.capture.card.device.empty()) settings.capture.card.device = "auto";
  CameraModel camera;
  camera.width = camera.height = 0;
  if (!settings.capture.camera.empty()) camera = loadCameraFile(settings.capture.camera);
  if (!settings.capture.card.device.empty())
    capture::requireSelection(settings.capture.card.device);
  else
    std::cout << "capture.device is empty: pictures come from capture.input\n\n";
  printDevices(std::cout, kernel::realSystemCalls(), cardSettings(settings.capture, camera));
  printDisplays(std::cout, kernel::realSystemCalls(), settings.display, camera.width, camera.height,
                settings.capture.fps > 0 ? settings.capture.fps : camera.fps);
  std::cout << '\n';
  printPedals(std::cout, kernel::realSystemCalls(), *makeGpioChips());
  return 0;
}

}  // namespace depthscope::platform
