#pragma once
#include <cstddef>
#include <span>
#include <utility>

#include "kernel/system_calls.hpp"

namespace depthscope::kernel {

/// Owns a stretch of mapped memory that came from a SystemCalls, which outlives it.
class Mapping {
 public:
  Mapping() = default;
  /// Invalid on failure, with -errno in `error`.
  Mapping(SystemCalls& calls, int fd, std::size_t length, bool writable, off_t offset, int& error)
      : calls_(&calls),
        address_(calls.mmap(fd, length, writable, offset, error)),
        length_(length) {}
  Mapping(Mapping&& other) noexcept
      : calls_(other.calls_),
        address_(std::exchange(other.address_, nullptr)),
        length_(other.length_) {}
  Mapping& operator=(Mapping&& other) noexcept {
    if (this != &other) {
      reset();
      calls_ = other.calls_;
      address_ = std::exchange(other.address_, nullptr);
      length_ = other.length_;
    }
    return *this;
  }
  ~Mapping() { reset(); }

  bool valid() const { return address_ != nullptr; }
  std::span<std::byte> bytes() const {
    return {static_cast<std::byte*>(address_), valid() ? length_ : 0};
  }
  void reset() {
    if (address_ != nullptr) calls_->munmap(std::exchange(address_, nullptr), length_);
  }

 private:
  SystemCalls* calls_ = nullptr;
  void* address_ = nullptr;
  std::size_t length_ = 0;  // [bytes]
};

}  // namespace depthscope::kernel
