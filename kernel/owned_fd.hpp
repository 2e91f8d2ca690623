#pragma once
#include <utility>

#include "kernel/system_calls.hpp"

namespace depthscope::kernel {

/// Owns a descriptor that came from a SystemCalls, which outlives it.
class OwnedFd {
 public:
  OwnedFd() = default;
  OwnedFd(SystemCalls& calls, int fd) : calls_(&calls), fd_(fd) {}
  OwnedFd(OwnedFd&& other) noexcept : calls_(other.calls_), fd_(std::exchange(other.fd_, -1)) {}
  OwnedFd& operator=(OwnedFd&& other) noexcept {
    if (this != &other) {
      reset();
      calls_ = other.calls_;
      fd_ = std::exchange(other.fd_, -1);
    }
    return *this;
  }
  ~OwnedFd() { reset(); }

  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }
  void reset() {
    if (fd_ >= 0) calls_->close(std::exchange(fd_, -1));
  }

 private:
  SystemCalls* calls_ = nullptr;
  int fd_ = -1;
};

}  // namespace depthscope::kernel
