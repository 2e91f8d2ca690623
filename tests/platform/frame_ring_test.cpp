#include "platform/ipc/frame_ring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>
#include <vector>

namespace depthscope::platform {
namespace {

/// A picture of this size with padding after each row, and a colour picture of one colour.
struct Picture {
  Picture(int width, int height, int stride, std::uint8_t value)
      : pixels(static_cast<std::size_t>(stride * height), 0xEE),
        view{pixels.data(), width, height, stride} {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        pixels[static_cast<std::size_t>(y * stride + x)] =
            static_cast<std::uint8_t>(value + x + 3 * y);
  }
  std::vector<std::uint8_t> pixels;
  GrayView view;
  ColorReduction size{view.width, view.height};
  std::vector<Rgb> rgb{size.pixels(), Rgb{pixels[0], 7, 9}};
  RgbView color{rgb.data(), size.width, size.height};
};

class FrameRingSizes : public ::testing::TestWithParam<std::tuple<int, int, int>> {};

TEST_P(FrameRingSizes, HandsOverEveryPixel) {
  const auto [width, height, stride] = GetParam();
  const SharedMemory memory = SharedMemory::create(
      {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 1, 1});
  FrameRingWriter writer(memory);
  FrameRingReader reader(memory);
  std::vector<std::uint8_t> out(static_cast<std::size_t>(width * height));
  std::vector<Rgb> color(memory.colorSize().pixels());
  WireFrameInfo info;
  EXPECT_FALSE(reader.takeNewest(out, color, info));
  for (int i = 0; i < 10; ++i) {
    const Picture picture(width, height, stride, static_cast<std::uint8_t>(i));
    writer.publish(picture.view, picture.color, {i, i / 30.0});
    ASSERT_TRUE(reader.takeNewest(out, color, info));
    EXPECT_EQ(info.frame, i);
    EXPECT_EQ(info.timestamp_s, i / 30.0);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(out[static_cast<std::size_t>(y * width + x)], picture.view.row(y)[x])
            << x << "," << y;
    EXPECT_EQ(color, picture.rgb);
    EXPECT_FALSE(reader.takeNewest(out, color, info));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FrameRingSizes,
                         ::testing::Values(std::tuple{64, 48, 64}, std::tuple{64, 48, 128},
                                           std::tuple{37, 11, 37}, std::tuple{37, 11, 64},
                                           std::tuple{1, 1, 1}));

TEST(FrameRing, TheNewestWinsAndTheRestIsCounted) {
  const SharedMemory memory = SharedMemory::create({16, 8, 1, 1});
  FrameRingWriter writer(memory);
  FrameRingReader reader(memory);
  const Picture picture(16, 8, 16, 0);
  for (int i = 0; i < 7; ++i) writer.publish(picture.view, picture.color, {i, 0});
  std::vector<std::uint8_t> out(128);
  std::vector<Rgb> color(128);
  WireFrameInfo info;
  ASSERT_TRUE(reader.takeNewest(out, color, info));
  EXPECT_EQ(info.frame, 6);
  EXPECT_EQ(reader.skipped(), 6u);
}

TEST(FrameRing, LeavesOutPicturesOfAnotherSize) {
  const SharedMemory memory = SharedMemory::create({16, 8, 1, 1});
  const Picture wide(17, 8, 17, 0), right(16, 8, 16, 0);
  FrameRingWriter(memory).publish(wide.view, right.color, {0, 0});
  FrameRingWriter(memory).publish(right.view, wide.color, {0, 0});
  FrameRingWriter(memory).publish(right.view, {}, {0, 0});
  std::vector<std::uint8_t> out(128);
  std::vector<Rgb> color(128);
  WireFrameInfo info;
  EXPECT_FALSE(FrameRingReader(memory).takeNewest(out, color, info));
}

TEST(FrameRing, ReadersSurviveGarbage) {
  const SharedMemory memory = SharedMemory::create({16, 8, 1, 1});
  std::mt19937_64 random(1);
  std::vector<std::uint8_t> out(128);
  std::vector<Rgb> color(128);
  WireFrameInfo info;
  FrameRingReader reader(memory);
  for (int i = 0; i < 5000; ++i) {
    SharedBlock& block = memory.block();
    block.frames_published.store(random());
    for (auto& slot : block.frames) {
      slot.count.store(random());
      for (auto& word : slot.info) word.store(random());
    }
    if (reader.takeNewest(out, color, info)) {
      EXPECT_GE(info.frame, 0);
      EXPECT_TRUE(std::isfinite(info.timestamp_s));
    }
  }
}

TEST(FrameRing, TwoThreadsNeverSeeATornPicture) {
  const SharedMemory memory = SharedMemory::create({64, 16, 1, 1});
  constexpr int pictures = 20000;
  std::thread thread([&] {
    FrameRingWriter writer(memory);
    std::vector<std::uint8_t> pixels(64 * 16);
    std::vector<Rgb> rgb(64 * 16);
    for (int i = 0; i < pictures; ++i) {
      const auto value = static_cast<std::uint8_t>(i);
      std::fill(pixels.begin(), pixels.end(), value);
      std::fill(rgb.begin(), rgb.end(), Rgb{value, value, value});
      writer.publish({pixels.data(), 64, 16, 64}, {rgb.data(), 64, 16}, {i, 0});
    }
  });
  FrameRingReader reader(memory);
  std::vector<std::uint8_t> out(64 * 16);
  std::vector<Rgb> color(64 * 16);
  WireFrameInfo info{-1, 0};
  while (info.frame < pictures - 1) {
    if (!reader.takeNewest(out, color, info)) continue;
    for (std::uint8_t p : out) ASSERT_EQ(p, static_cast<std::uint8_t>(info.frame));
    for (const Rgb& c : color) ASSERT_EQ(c[2], static_cast<std::uint8_t>(info.frame));
  }
  thread.join();
}

}  // namespace
}  // namespace depthscope::platform
