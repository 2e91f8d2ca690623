#pragma once
#include <poll.h>
#include <sys/types.h>

#include <cerrno>
#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "kernel/bell.hpp"

namespace depthscope::kernel {

/// What the program asks of the operating system for its devices: the calls of open(2), ioctl(2)
/// and their kin, and the clock. Every call that a device driver of ours makes goes through one
/// object of this interface, so that a test can answer them, fail them and move the clock.
///
/// Errors come as -errno in the result; errno itself means nothing here. No call throws. A call
/// that a signal interrupts says -EINTR: the caller tries again or gives the turn up, but never
/// counts on being spared.
class SystemCalls {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  virtual ~SystemCalls() = default;

  /// Descriptor or -errno. `flags` as open(2) takes them; O_CLOEXEC is added.
  virtual int open(const char* path, int flags) = 0;
  virtual int close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Shared mapping of `length` bytes at `offset`: readable, and writable where asked. Null on
  /// failure, with -errno in `error`.
  virtual void* mmap(int fd, std::size_t length, bool writable, off_t offset, int& error) = 0;
  virtual int munmap(void* address, std::size_t length) = 0;
  virtual ssize_t read(int fd, std::span<std::byte> into) = 0;
  virtual ssize_t write(int fd, std::span<const std::byte> from) = 0;
  /// Number of descriptors with events, 0 after `timeout`, or -errno. Never waits without an end: a
  /// negative timeout is taken as none.
  virtual int poll(std::span<pollfd> descriptors, std::chrono::nanoseconds timeout) = 0;
  /// Until the bell was rung after it told `rings`: 0. -ETIMEDOUT after `timeout`, or -errno; a
  /// ring may also be one that was waited for before.
  virtual int waitForRing(const Bell& bell, std::uint32_t rings,
                          std::chrono::nanoseconds timeout) = 0;
  /// Names in a directory, sorted, without "." and ".."; -errno or 0.
  virtual int list(const char* directory, std::vector<std::string>& names) = 0;
  /// Where a symbolic link points to (as readlink(2) says it); -errno or 0.
  virtual int readLink(const char* path, std::string& target) = 0;

  /// CLOCK_MONOTONIC.
  virtual Time now() = 0;
};

/// The operating system itself.
SystemCalls& realSystemCalls();

/// The call again for as long as a signal interrupts it, `attempts` times at most: a storm of
/// signals must not hold a real-time loop.
template <typename Call>
auto retryInterrupted(Call&& call, int attempts = 8) {
  auto result = call();
  while (result == -EINTR && --attempts > 0) result = call();
  return result;
}

}  // namespace depthscope::kernel
