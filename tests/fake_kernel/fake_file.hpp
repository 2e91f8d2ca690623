#pragma once
#include <cerrno>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "kernel/system_calls.hpp"

namespace depthscope::fake {

using Time = kernel::SystemCalls::Time;

/// An open file of a fake device; destroyed when its last descriptor is closed. What a device does
/// not know, it refuses as the kernel does.
class FakeFile {
 public:
  virtual ~FakeFile() = default;
  virtual int ioctl(unsigned long /*request*/, void* /*argument*/) { return -ENOTTY; }
  /// Memory of the device that lives as long as the mapping, or null with -errno in `error`.
  virtual std::shared_ptr<std::byte[]> map(std::size_t /*length*/, off_t /*offset*/, int& error) {
    error = -ENODEV;
    return nullptr;
  }
  virtual ssize_t read(std::span<std::byte>) { return -EINVAL; }
  virtual ssize_t write(std::span<const std::byte>) { return -EINVAL; }
  /// The poll(2) events that hold now.
  virtual short events() { return 0; }
  /// When something happens next by itself (a frame arrives, a flip completes); none: never.
  virtual std::optional<Time> nextEvent() { return std::nullopt; }
};

/// What stands behind a path under /dev.
class FakeDevice {
 public:
  virtual ~FakeDevice() = default;
  /// 0 and a file, or -errno.
  virtual int open(int flags, std::unique_ptr<FakeFile>& file) = 0;
};

}  // namespace depthscope::fake
