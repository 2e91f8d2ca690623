#include "platform/tool/list_displays.hpp"

#include <iomanip>
#include <ostream>
#include <system_error>

#include "platform/display/kms/mode_choice.hpp"
#include "platform/display/kms/monitor_watch.hpp"

namespace depthscope::platform {
namespace {

void printMode(std::ostream& out, const drm_mode_modeinfo& mode) {
  out << mode.hdisplay << 'x' << mode.vdisplay << '@' << std::fixed << std::setprecision(2)
      << kms::refreshRate(mode);
  if (mode.flags & DRM_MODE_FLAG_INTERLACE) out << " interlaced";
  if (mode.type & DRM_MODE_TYPE_PREFERRED) out << " preferred";
}

void printError(std::ostream& out, int error) {
  out << (error == -EOPNOTSUPP ? "its driver has no atomic modesetting"
                               : std::generic_category().message(-error))
      << '\n';
}

void printConnectors(std::ostream& out, const kms::Card& card) {
  std::vector<std::uint32_t> ids;
  if (const int error = card.connectors(ids)) return printError(out << "  ", error);
  for (const std::uint32_t id : ids) {
    kms::Connector connector;
    if (const int error = card.connector(id, true, connector)) {
      printError(out << "  connector " << id << ": ", error);
      continue;
    }
    out << "  " << connector.name << (connector.connected ? "" : "  no monitor") << '\n';
    for (const drm_mode_modeinfo& mode : connector.modes)
      printMode(out << "    ", mode), out << '\n';
  }
}

/// The first card and connector that fit the settings, as the daemon would take them.
bool printChoice(std::ostream& out, const std::string& path, const kms::Card& card,
                 const DisplaySettings& settings, const kms::PictureRate& picture) {
  kms::Connector connector;
  if (kms::findMonitor(card, settings.connector, connector) != 0) return false;
  const auto mode = kms::chooseMode(connector.modes, picture, parseModeRequest(settings.mode));
  if (!mode) return false;
  out << "display.device = \"" << settings.device << "\": " << path << ", " << connector.name
      << ", ";
  printMode(out, connector.modes[*mode]);
  out << '\n';
  return true;
}

}  // namespace

void printDisplays(std::ostream& out, kernel::SystemCalls& calls, const DisplaySettings& settings,
                   int width, int height, double fps) {
  const auto paths = kms::cardPaths(calls);
  if (paths.empty()) out << "no graphics card found\n";
  for (const std::string& path : paths) {
    kms::Card card;
    out << path;
    if (const int error = kms::Card::open(calls, path, card)) {
      printError(out << ": ", error);
      continue;
    }
    out << '\n';
    printConnectors(out, card);
  }
  const bool any = settings.device == "auto";
  for (const std::string& path : any ? paths : std::vector<std::string>{settings.device}) {
    kms::Card card;
    if (kms::Card::open(calls, path, card) == 0 &&
        printChoice(out, path, card, settings, {width, height, fps}))
      return;
  }
  out << "display.device = \"" << settings.device << "\", display.connector = \""
      << settings.connector << "\": no monitor found\n";
}

}  // namespace depthscope::platform
