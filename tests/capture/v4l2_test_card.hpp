#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "capture/pixel_convert.hpp"
#include "capture/v4l2_source.hpp"
#include "tests/fake_kernel/fake_v4l2_card.hpp"

namespace depthscope::capture {

using namespace std::chrono_literals;
using fake::FakeKernel;
using fake::FakeV4l2Card;
using fake::Rgb;

inline std::vector<std::uint8_t> rgbaOf(const Frame& frame) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(frame.format.width) *
                                static_cast<std::size_t>(frame.format.height) * 4);
  toRgba(frame, out);
  return out;
}

/// Eight 100 % bars across 64 pixels, moving by two pixels a frame.
inline Rgb bars(int x, int, std::uint64_t index, int) {
  const int bar = (x + 2 * static_cast<int>(index)) / 8 % 8;
  return {(bar & 2) ? 0.0 : 1.0, (bar & 4) ? 0.0 : 1.0, (bar & 1) ? 0.0 : 1.0};
}

/// Largest difference, in levels, of a frame to what the camera saw.
inline double farthest(const Frame& frame, const std::function<Rgb(int x, int y)>& scene) {
  const auto pixels = rgbaOf(frame);
  double most = 0;
  for (int y = 0; y < frame.format.height; ++y)
    for (int x = 0; x < frame.format.width; ++x) {
      const std::uint8_t* p = &pixels[4 * static_cast<std::size_t>(y * frame.format.width + x)];
      const Rgb c = scene(x, y);
      most = std::max({most, std::abs(p[0] - 255 * c.r), std::abs(p[1] - 255 * c.g),
                       std::abs(p[2] - 255 * c.b)});
    }
  return most;
}

/// A kernel with one card at /dev/video0, and a source for it.
class V4l2Test : public testing::Test {
 protected:
  FakeV4l2Card& plug(FakeV4l2Card::Options options) {
    source.reset();
    card = std::make_unique<FakeV4l2Card>(kernel, std::move(options));
    card->setScene(bars);
    kernel.plug("/dev/video0", *card);
    return *card;
  }
  V4l2Source& open(V4l2Settings settings = {}) {
    if (settings.device.empty()) settings.device = "auto";
    source = std::make_unique<V4l2Source>(settings, kernel);
    return *source;
  }
  /// Reads until there is a picture, for `limit` of simulated time at most.
  Frame nextPicture(std::chrono::nanoseconds limit = 500ms) {
    const auto end = kernel.now() + limit;
    while (kernel.now() < end)
      if (ReadResult result = source->read(80ms); result.status == SourceStatus::Ok)
        return std::move(result.frame);
    return {};
  }
  /// Reads pictures until there is something else to say.
  SourceStatus nextFault(int most = 20) {
    for (int i = 0; i < most; ++i)
      if (const ReadResult result = source->read(80ms); result.status != SourceStatus::Ok)
        return result.status;
    return SourceStatus::Ok;
  }
  void TearDown() override {
    source.reset();
    EXPECT_EQ(kernel.openDescriptors(), 0u);
    EXPECT_EQ(kernel.mappings(), 0u);
    EXPECT_EQ(kernel.misuses(), 0u);
  }

  FakeKernel kernel;
  std::unique_ptr<FakeV4l2Card> card;
  std::unique_ptr<V4l2Source> source;
};

}  // namespace depthscope::capture
