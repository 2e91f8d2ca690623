#include "overlay/blend.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

namespace depthscope::overlay {
namespace {

TEST(Blend, KeepsThePictureWhereTheLayerIsTransparent) {
  for (int n : {1, 7, 8, 9, 64, 101}) {
    std::vector<std::uint8_t> layer(static_cast<std::size_t>(4 * n), 0), picture(layer.size()),
        out(layer.size(), 1);
    for (std::size_t i = 0; i < picture.size(); ++i)
      picture[i] = static_cast<std::uint8_t>(i * 37 + 11);
    blendRow(layer.data(), picture.data(), out.data(), n);
    EXPECT_EQ(out, picture) << n;
    for (std::size_t i = 0; i < layer.size(); ++i) layer[i] = i % 4 == 3 ? 0 : 1;
    blendRow(layer.data(), picture.data(), out.data(), n);
    EXPECT_EQ(out, picture) << "colour without alpha is not part of the layer";
  }
}

TEST(Blend, IsTheRoundedOverOperatorForEveryAlphaAndValue) {
  for (int alpha = 0; alpha < 256; ++alpha)
    for (int value = 0; value < 256; ++value) {
      const auto a = static_cast<std::uint8_t>(alpha), v = static_cast<std::uint8_t>(value);
      const auto c = static_cast<std::uint8_t>(alpha / 3);
      std::vector<std::uint8_t> layer, picture;
      for (int i = 0; i < 9; ++i) {
        layer.insert(layer.end(), {c, c, c, a});
        picture.insert(picture.end(), {v, v, v, 200});
      }
      blendRow(layer.data(), picture.data(), picture.data(), 9);
      const int expected = c + static_cast<int>(std::lround(value * (255 - alpha) / 255.0));
      for (std::size_t i = 0; i < picture.size(); ++i)
        ASSERT_EQ(picture[i], i % 4 == 3 ? 200 : std::min(expected, 255))
            << alpha << " " << value << " " << i;
    }
}

TEST(Blend, SaturatesInsteadOfWrapping) {
  std::vector<std::uint8_t> layer{250, 250, 250, 10}, picture{255, 255, 255, 255};
  blendRow(layer.data(), picture.data(), picture.data(), 1);
  EXPECT_THAT(picture, testing::Each(255));
}

}  // namespace
}  // namespace depthscope::overlay
