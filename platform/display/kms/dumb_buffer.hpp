#pragma once
#include <utility>

#include "kernel/mapping.hpp"
#include "platform/display/kms/card.hpp"

namespace depthscope::platform::kms {

/// A framebuffer in memory that the processor writes and the display scans out, 32 bits a pixel.
/// Belongs to a card, which outlives it at its place.
class DumbBuffer {
 public:
  DumbBuffer() = default;
  /// 0 or -errno. `fourcc`: DRM_FORMAT_..., of 32 bits a pixel. All bytes are zero.
  static int create(Card& card, int width, int height, std::uint32_t fourcc, DumbBuffer& buffer);
  DumbBuffer(DumbBuffer&& other) noexcept { *this = std::move(other); }
  DumbBuffer& operator=(DumbBuffer&& other) noexcept;
  ~DumbBuffer() { reset(); }

  std::uint32_t framebuffer() const { return framebuffer_; }
  int pitch() const { return static_cast<int>(pitch_); }  // [bytes]
  std::span<std::uint8_t> bytes() const {
    const auto mapped = mapping_.bytes();
    return {reinterpret_cast<std::uint8_t*>(mapped.data()), mapped.size()};
  }
  void reset();

 private:
  Card* card_ = nullptr;
  std::uint32_t handle_ = 0, framebuffer_ = 0, pitch_ = 0;
  kernel::Mapping mapping_;
};

}  // namespace depthscope::platform::kms
