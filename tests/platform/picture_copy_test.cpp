#include "platform/display/picture_copy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace depthscope::platform {
namespace {

/// A picture whose pixels all differ.
std::vector<std::uint8_t> makePicture(int width, int height) {
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < width * height; ++i)
    for (const int v : {i * 7, i * 5 + 80, i * 3 + 160, 255})
      rgba.push_back(static_cast<std::uint8_t>(v));
  return rgba;
}

TEST(PictureCopy, EveryLayoutHoldsThePixelsUnchanged) {
  constexpr int width = 37, height = 5, stride = 200;
  const auto picture = makePicture(width, height);
  for (const PixelLayout layout :
       {PixelLayout::Rgbx32, PixelLayout::Bgrx32, PixelLayout::Bgr24, PixelLayout::Rgb565}) {
    std::vector<std::uint8_t> screen(stride * height, 0xee);
    PictureCopier().copy({picture.data(), width, height, width * 4},
                         {screen.data(), width, height, stride, layout});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::uint8_t* in = &picture[static_cast<std::size_t>((y * width + x) * 4)];
        const std::uint8_t* out =
            &screen[static_cast<std::size_t>(y * stride + x * bytesPerPixel(layout))];
        if (layout == PixelLayout::Rgb565) {
          std::uint16_t word = 0;
          std::memcpy(&word, out, 2);
          EXPECT_EQ(word >> 11, in[0] >> 3);
          EXPECT_EQ(word >> 5 & 63, in[1] >> 2);
          EXPECT_EQ(word & 31, in[2] >> 3);
        } else {
          const bool swapped = layout != PixelLayout::Rgbx32;
          EXPECT_EQ(out[0], in[swapped ? 2 : 0]);
          EXPECT_EQ(out[1], in[1]);
          EXPECT_EQ(out[2], in[swapped ? 0 : 2]);
        }
      }
    for (int y = 0; y < height; ++y)  // what lies between the rows is not ours
      EXPECT_EQ(screen[static_cast<std::size_t>(y * stride + width * bytesPerPixel(layout))], 0xee);
  }
}

TEST(PictureCopy, CentresPixelForPixel) {
  const Placement place = placePicture(30, 20, 41, 24);
  EXPECT_EQ(place.x, 5);
  EXPECT_EQ(place.y, 2);
  EXPECT_EQ(place.width, 30);
  EXPECT_EQ(place.height, 20);
  const auto picture = makePicture(30, 20);
  std::vector<std::uint8_t> screen(41 * 24 * 4, 1);
  PictureCopier().copy({picture.data(), 30, 20, 120},
                       {screen.data(), 41, 24, 41 * 4, PixelLayout::Rgbx32});
  EXPECT_EQ(std::memcmp(&screen[(2 * 41 + 5) * 4], picture.data(), 120), 0);
  EXPECT_EQ(screen[(2 * 41 + 4) * 4], 1);
  EXPECT_EQ(screen[(2 * 41 + 35) * 4], 1);
}

TEST(PictureCopy, ScalesDownInProportion) {
  const Placement wide = placePicture(200, 50, 100, 100);
  EXPECT_EQ(wide.width, 100);
  EXPECT_EQ(wide.height, 25);
  EXPECT_EQ(wide.y, 37);
  const Placement tall = placePicture(50, 200, 100, 100);
  EXPECT_EQ(tall.width, 25);
  EXPECT_EQ(tall.height, 100);
}

TEST(PictureCopy, HalfTheSizeIsTheMeanOfFourPixels) {
  std::vector<std::uint8_t> picture;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      for (const int v : {x * 16, y * 16, 100, 255})
        picture.push_back(static_cast<std::uint8_t>(v));
  std::vector<std::uint8_t> screen(4 * 4 * 4);
  PictureCopier().copy({picture.data(), 8, 8, 32}, {screen.data(), 4, 4, 16, PixelLayout::Rgbx32});
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const std::uint8_t* p = &screen[static_cast<std::size_t>((y * 4 + x) * 4)];
      EXPECT_EQ(p[0], x * 32 + 8);
      EXPECT_EQ(p[1], y * 32 + 8);
      EXPECT_EQ(p[2], 100);
      EXPECT_EQ(p[3], 255);
    }
}

}  // namespace
}  // namespace depthscope::platform
