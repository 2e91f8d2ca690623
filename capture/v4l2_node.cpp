#include "capture/v4l2_node.hpp"

#include <fcntl.h>

#include <cstring>

namespace depthscope::capture {
namespace {

template <std::size_t size>
std::string text(const __u8 (&field)[size]) {
  const char* start = reinterpret_cast<const char*>(field);
  return {start, ::strnlen(start, size)};
}

}  // namespace

int V4l2Node::open(kernel::SystemCalls& calls, const std::string& path, V4l2Node& node) {
  const int fd =
      kernel::retryInterrupted([&] { return calls.open(path.c_str(), O_RDWR | O_NONBLOCK); });
  if (fd < 0) return fd;
  V4l2Node opened;
  opened.calls_ = &calls;
  opened.fd_ = kernel::OwnedFd(calls, fd);
  opened.path_ = path;
  v4l2_capability who{};
  if (const int error = opened.ask(VIDIOC_QUERYCAP, who); error < 0) return error;
  const __u32 can = who.capabilities & V4L2_CAP_DEVICE_CAPS ? who.device_caps : who.capabilities;
  const bool captures = can & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE);
  if (!captures || !(can & V4L2_CAP_STREAMING)) return -ENOTTY;
  opened.multiplanar_ = !(can & V4L2_CAP_VIDEO_CAPTURE);
  opened.driver_ = text(who.driver);
  opened.card_ = text(who.card);
  opened.bus_ = text(who.bus_info);
  node = std::move(opened);
  return 0;
}

}  // namespace depthscope::capture
