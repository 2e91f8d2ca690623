#include <algorithm>
#include <charconv>
#include <system_error>

#include "capture/v4l2_devices.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

constexpr std::string_view kName = "name:", kBus = "bus:";

bool matches(const V4l2Node& node, std::string_view selection) {
  if (selection.starts_with(kName))
    return node.card().find(selection.substr(kName.size())) != std::string::npos;
  if (selection.starts_with(kBus)) return node.bus() == selection.substr(kBus.size());
  return true;
}

/// The number behind "video", or -1 for another name.
int videoNumber(std::string_view name) {
  constexpr std::string_view kVideo = "video";
  int number = -1;
  if (!name.starts_with(kVideo)) return -1;
  const char* end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + kVideo.size(), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end ? number : -1;
}

}  // namespace

std::vector<std::string> videoNodes(kernel::SystemCalls& calls) {
  std::vector<std::string> names;
  if (calls.list("/dev", names) < 0) return {};
  std::erase_if(names, [](const std::string& name) { return videoNumber(name) < 0; });
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return videoNumber(a) < videoNumber(b);
  });
  for (std::string& name : names) name = "/dev/" + name;
  return names;
}

std::string errorText(int error) {
  return std::generic_category().message(error < 0 ? -error : error);
}

void requireSelection(const std::string& selection) {
  const auto names = [&](std::string_view prefix) {
    return selection.starts_with(prefix) && selection.size() > prefix.size();
  };
  if (selection == "auto" || names(kName) || names(kBus) || names("/")) return;
  throw InputError("\"" + selection +
                   "\": expected \"auto\", a path, \"name:TEXT\" or \"bus:TEXT\"");
}

int openSelected(kernel::SystemCalls& calls, std::string_view selection, V4l2Node& node,
                 std::string& detail) {
  if (selection.starts_with('/')) {
    const std::string path(selection);
    const int error = V4l2Node::open(calls, path, node);
    if (error == -ENOTTY)
      detail = path + " does not capture video";
    else if (error < 0)
      detail = path + ": " + errorText(error);
    return error;
  }
  int refused = 0, nodes = 0;
  for (const std::string& path : videoNodes(calls)) {
    V4l2Node candidate;
    const int error = V4l2Node::open(calls, path, candidate);
    if (error == 0 && matches(candidate, selection)) {
      node = std::move(candidate);
      return 0;
    }
    ++nodes;
    if (error < 0 && error != -ENOTTY && refused == 0) {
      refused = error;
      detail = path + ": " + errorText(error);
    }
  }
  if (refused != 0) return refused;
  detail = nodes == 0
               ? std::string("no capture device found")
               : "none of " + std::to_string(nodes) + " video nodes is " + std::string(selection);
  return -ENODEV;
}

}  // namespace depthscope::capture
