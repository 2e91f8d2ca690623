#include "capture/v4l2_edid.hpp"

#include <algorithm>
#include <vector>

#include "capture/edid.hpp"

namespace depthscope::capture {
namespace {

/// The blocks there are, at most as many as `room` holds; -ENODATA: memory without content.
int getEdid(const V4l2Node& node, int input, std::vector<std::uint8_t>& room) {
  v4l2_edid request{};
  request.pad = static_cast<__u32>(input);
  request.blocks = static_cast<__u32>(room.size() / kEdidBlock);
  request.edid = room.data();
  const int error = node.ask(VIDIOC_G_EDID, request);
  room.resize(error < 0 ? 0 : std::min<std::size_t>(request.blocks * kEdidBlock, room.size()));
  return error;
}

}  // namespace

bool hasEdid(const V4l2Node& node, int input) {
  std::vector<std::uint8_t> edid(256 * kEdidBlock);
  const int error = getEdid(node, input, edid);
  return error == 0 || error == -ENODATA;
}

int offerEdid(const V4l2Node& node, int input, std::span<const std::uint8_t> edid,
              bool only_where_missing) {
  std::vector<std::uint8_t> present(256 * kEdidBlock);
  const int error = getEdid(node, input, present);
  if (error == -ENOTTY || error == -EINVAL) return 0;  // no EDID memory, or none for this input
  if (error < 0 && error != -ENODATA) return error;
  if (only_where_missing && !present.empty()) return 0;
  if (std::equal(edid.begin(), edid.end(), present.begin(), present.end())) return 0;
  std::vector<std::uint8_t> bytes(edid.begin(), edid.end());
  v4l2_edid request{};
  request.pad = static_cast<__u32>(input);
  request.blocks = static_cast<__u32>(bytes.size() / kEdidBlock);
  request.edid = bytes.data();
  const int failed = node.ask(VIDIOC_S_EDID, request);
  return failed == -ENOTTY ? 0 : failed;
}

}  // namespace depthscope::capture
