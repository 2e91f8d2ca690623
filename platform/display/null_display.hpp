#pragma once
#include <vector>

#include "platform/display/display.hpp"

namespace depthscope::platform {

/// Pictures go nowhere: for tests, and for boxes that only record poses.
class NullDisplay : public Display {
 public:
  std::span<std::uint8_t> acquire(int width, int height) override {
    const auto bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
    if (buffer_.size() < bytes) buffer_.resize(bytes);
    return std::span(buffer_).first(bytes);
  }
  void present(std::int64_t) override {}
  DisplayState state() const override { return DisplayState::Ok; }

 private:
  std::vector<std::uint8_t> buffer_;
};

}  // namespace depthscope::platform
