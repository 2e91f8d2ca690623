#include "overlay/stamp.hpp"

#include <gmock/gmock.h>

namespace depthscope::overlay {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes gray(int width, int height, std::uint8_t value) {
  return Bytes(static_cast<std::size_t>(width * height * 4), value);
}

Stamp filled(int width, int height, Color color) {
  Stamp stamp(width, height);
  const Eigen::Vector2f half(0.5f * static_cast<float>(width), 0.5f * static_cast<float>(height));
  stamp.box(half, half, 0, 0, color);
  return stamp;
}

TEST(Stamp, AnEmptyOneLeavesThePictureAlone) {
  Bytes picture = gray(8, 8, 77);
  Stamp(4, 4).overPicture(2, 2, picture, 8, 8);
  EXPECT_THAT(picture, testing::Each(77));
}

TEST(Stamp, CoversItsPlaceAndNothingElse) {
  Bytes picture = gray(8, 8, 100);
  filled(2, 3, {1, 1, 1, 1}).overPicture(5, 4, picture, 8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const bool inside = x >= 5 && x < 7 && y >= 4 && y < 7;
      EXPECT_EQ(picture[static_cast<std::size_t>(4 * (8 * y + x))], inside ? 255 : 100) << x << y;
    }
}

TEST(Stamp, IsClippedAtEveryEdge) {
  for (const auto& [x, y] : {std::pair{-1, -1}, {7, 7}, {-1, 7}, {-5, 3}, {3, 9}}) {
    Bytes picture = gray(8, 8, 100);
    filled(3, 3, {0, 0, 0, 1}).overPicture(x, y, picture, 8, 8);
    for (int py = 0; py < 8; ++py)
      for (int px = 0; px < 8; ++px) {
        const bool inside = px >= x && px < x + 3 && py >= y && py < y + 3;
        ASSERT_EQ(picture[static_cast<std::size_t>(4 * (8 * py + px))], inside ? 0 : 100);
      }
  }
}

TEST(Stamp, OverALayerItsAlphaAddsUp) {
  const PixelRect rect{10, 20, 14, 24};
  Bytes layer = gray(4, 4, 0);
  const Stamp half = filled(2, 2, {1, 0, 0, 0.5f});
  half.overLayer(11, 21, layer, rect);
  half.overLayer(11, 21, layer, rect);
  const std::uint8_t* p = layer.data() + 4 * (4 + 1);
  EXPECT_NEAR(p[0], 191, 1);
  EXPECT_EQ(p[1], 0);
  EXPECT_NEAR(p[3], 191, 1);
  EXPECT_EQ(layer[0], 0);
  EXPECT_EQ(layer[3], 0);
}

TEST(Stamp, ARingIsHollowAndALineIsAsWideAsAsked) {
  Stamp stamp(21, 21);
  stamp.ring({10.5f, 10.5f}, 9, 3, {1, 1, 1, 1});
  stamp.line({3, 10.5f}, {18, 10.5f}, 3, {0, 1, 0, 1});
  Bytes picture = gray(21, 21, 0);
  stamp.overPicture(0, 0, picture, 21, 21);
  const auto green = [&](int x, int y) {
    return picture[static_cast<std::size_t>(4 * (21 * y + x) + 1)];
  };
  EXPECT_EQ(green(10, 10), 255);
  EXPECT_EQ(green(10, 9), 255);
  EXPECT_EQ(green(10, 7), 0);
  EXPECT_EQ(green(10, 2), 255) << "the ring";
}

}  // namespace
}  // namespace depthscope::overlay
