#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "capture/frame.hpp"

namespace depthscope::platform {

/// A clock in binary, drawn into the pictures that go in and read from those that come out: what a
/// picture says is when it was captured, whatever the program under test believes. Two rows of
/// blocks along the picture's lower border, bright for 1, dark for 0: 40 bits of microseconds
/// (twelve days) and 8 of a check sum.
class BinaryClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  BinaryClock(int width, int height)
      : width_(width), height_(height), block_(width / (columns + 2)) {}

  /// Into the luma of a planar YUV or grey picture.
  void draw(capture::Frame& frame, Time time) const {
    const std::uint64_t word = encode(time);
    for (int bit = 0; bit < bits; ++bit)
      for (int y = 0; y < block_; ++y)
        for (int x = 0; x < block_; ++x)
          frame.planes[0].data[(top(bit) + y) * frame.planes[0].stride + left(bit) + x] =
              (word >> bit & 1) != 0 ? 225 : 25;
  }
  /// From an R G B A picture; nothing where there is no such clock.
  std::optional<Time> read(std::span<const std::uint8_t> rgba) const {
    std::uint64_t word = 0;
    for (int bit = 0; bit < bits; ++bit) {
      const int x = left(bit) + block_ / 2, y = top(bit) + block_ / 2;
      const auto at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x));
      const int luma = (77 * rgba[at] + 150 * rgba[at + 1] + 29 * rgba[at + 2]) / 256;
      if (luma > 125) word |= std::uint64_t{1} << bit;
    }
    const std::uint64_t us = word & mask;
    if (word >> time_bits != checkSum(us)) return std::nullopt;
    return Time(std::chrono::microseconds(us));
  }

 private:
  static constexpr int columns = 24, bits = 48, time_bits = 40;
  static constexpr std::uint64_t mask = (std::uint64_t{1} << time_bits) - 1;

  static std::uint64_t checkSum(std::uint64_t us) { return (us * 0x9e3779b97f4a7c15u) >> 56; }
  static std::uint64_t encode(Time time) {
    const auto us = static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count());
    return (us & mask) | checkSum(us & mask) << time_bits;
  }
  int left(int bit) const { return (bit % columns + 1) * block_; }
  int top(int bit) const { return height_ - (3 - bit / columns) * block_; }

  int width_, height_, block_;
};

}  // namespace depthscope::platform
