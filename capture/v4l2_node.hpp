#pragma once
#include <linux/videodev2.h>

#include <string>

#include "kernel/owned_fd.hpp"

namespace depthscope::capture {

/// An open V4L2 device node that captures video by streaming, with the single- or the multi-planar
/// interface.
class V4l2Node {
 public:
  V4l2Node() = default;
  /// Opens without blocking and asks who it is. 0 or -errno; -ENOTTY for a node that does not
  /// capture.
  static int open(kernel::SystemCalls& calls, const std::string& path, V4l2Node& node);

  bool valid() const { return fd_.valid(); }
  int fd() const { return fd_.get(); }
  void close() { fd_.reset(); }
  /// ioctl(2), again when interrupted; 0 or more, or -errno.
  template <typename Argument>
  int ask(unsigned long request, Argument& argument) const {
    return kernel::retryInterrupted([&] { return calls_->ioctl(fd_.get(), request, &argument); });
  }

  bool multiplanar() const { return multiplanar_; }
  v4l2_buf_type bufferType() const {
    return multiplanar_ ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  }
  const std::string& path() const { return path_; }
  const std::string& driver() const { return driver_; }
  const std::string& card() const { return card_; }  // its name
  const std::string& bus() const { return bus_; }    // where it is plugged in

 private:
  kernel::SystemCalls* calls_ = nullptr;
  kernel::OwnedFd fd_;
  bool multiplanar_ = false;
  std::string path_, driver_, card_, bus_;
};

}  // namespace depthscope::capture
