#include "platform/display/kms/monitor_watch.hpp"

#include <fcntl.h>

#include <array>
#include <string_view>

namespace depthscope::platform::kms {
namespace {

constexpr const char* class_folder = "/sys/class/drm";

}  // namespace

std::string statusPath(const Card& card, const Connector& connector) {
  return std::string(class_folder) + "/" + card.name() + "-" + connector.name + "/status";
}

Connection connection(kernel::SystemCalls& calls, const std::string& status_path) {
  const kernel::OwnedFd file(calls, calls.open(status_path.c_str(), O_RDONLY));
  if (!file.valid()) return Connection::Unknown;
  std::array<std::byte, 32> text;
  const ssize_t got = kernel::retryInterrupted([&] { return calls.read(file.get(), text); });
  if (got <= 0) return Connection::Unknown;
  const std::string_view word(reinterpret_cast<const char*>(text.data()),
                              static_cast<std::size_t>(got));
  if (word.starts_with("disconnected")) return Connection::Disconnected;
  return word.starts_with("connected") ? Connection::Connected : Connection::Unknown;
}

bool monitorSeen(kernel::SystemCalls& calls, const std::string& card,
                 const std::string& connector) {
  std::vector<std::string> names;
  if (calls.list(class_folder, names) != 0) return true;
  bool any = false;
  for (const std::string& name : names) {  // "card0-HDMI-A-1"; cards and render nodes have no dash
    const auto dash = name.find('-');
    if (dash == std::string::npos) continue;
    if (!card.empty() && name.substr(0, dash) != card) continue;
    if (connector != "auto" && name.substr(dash + 1) != connector) continue;
    any = true;
    const std::string path = std::string(class_folder) + "/" + name + "/status";
    if (connection(calls, path) != Connection::Disconnected) return true;
  }
  return !any;
}

int findMonitor(const Card& card, const std::string& wanted, Connector& out) {
  std::vector<std::uint32_t> ids;
  if (const int error = card.connectors(ids)) return error;
  for (const std::uint32_t id : ids) {
    Connector connector;
    if (wanted != "auto") {  // asking a monitor takes time: only the one that is meant
      if (const int error = card.connector(id, false, connector)) return error;
      if (connector.name != wanted) continue;
    }
    if (const int error = card.connector(id, true, connector)) return error;
    if (!connector.connected || connector.modes.empty()) continue;
    out = std::move(connector);
    return 0;
  }
  return -ENOLINK;
}

}  // namespace depthscope::platform::kms
