#include "slam/image_pyramid.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "slam/binomial_smoothing.hpp"
#include "tests/slam/tissue_picture.hpp"

namespace depthscope::slam {
namespace {

void expectSamePixels(const ImageBuffer& a, const ImageBuffer& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  for (int y = 0; y < a.height(); ++y) ASSERT_EQ(std::memcmp(a.row(y), b.row(y), a.width()), 0);
}

TEST(ImagePyramid, PixelsShowThePlaceTheirAreaCovers) {
  // On a ramp, bilinear interpolation is exact and the grey level tells the position, up to what
  // the rounding of seven levels adds. Were corners to coincide, level 7 would be off by 2.8.
  const ImageBuffer ramp = testing::draw(120, 90, [](double x, double y) { return 1.2 * x + y; });
  ImagePyramid pyramid(120, 90, 8, 1.2);
  pyramid.build(ramp.view(), SimdPath::Portable);
  for (int l = 0; l < pyramid.levels(); ++l) {
    const ImageBuffer& level = pyramid.level(l);
    double error = 0;
    int pixels = 0;
    EXPECT_NEAR(level.width(), 120 / pyramid.scale(l), 0.5);
    for (int y = 4; y < level.height() - 4; ++y)
      for (int x = 4; x < level.width() - 4; ++x) {
        const double u = (x + 0.5) * pyramid.scale(l) - 0.5, v = (y + 0.5) * pyramid.scale(l) - 0.5;
        error += level.row(y)[x] - (1.2 * u + v);
        ++pixels;
        EXPECT_NEAR(level.row(y)[x], 1.2 * u + v, 3);
      }
    EXPECT_NEAR(error / pixels, 0, 1);
  }
}

TEST(ImagePyramid, IsTheSameOnEveryPath) {
  if (!isAvailable(SimdPath::Avx2)) GTEST_SKIP() << "not on this processor";
  const ImageBuffer image = testing::draw(157, 93, testing::TissueTexture(3));
  ImagePyramid a(157, 93, 6, 1.2), b(157, 93, 6, 1.2);
  a.build(image.view(), SimdPath::Portable);
  b.build(image.view(), SimdPath::Avx2);
  for (int l = 0; l < a.levels(); ++l) expectSamePixels(a.level(l), b.level(l));
}

TEST(BinomialSmoothing, IsTheKernelOneTwoOneBothWaysRoundedUp) {
  const ImageBuffer image = testing::draw(75, 40, testing::TissueTexture(4));
  ImageBuffer smooth(75, 40);
  BinomialSmoothing(75)(image, smooth, SimdPath::Portable);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 75; ++x) {
      double sum = 0;
      for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u)
          sum += image.row(std::clamp(y + v, 0, 39))[std::clamp(x + u, 0, 74)] * (2 - std::abs(u)) *
                 (2 - std::abs(v)) / 16.0;
      EXPECT_GE(smooth.row(y)[x], sum);
      EXPECT_LE(smooth.row(y)[x], sum + 2);
    }
}

TEST(BinomialSmoothing, IsTheSameOnEveryPath) {
  if (!isAvailable(SimdPath::Avx2)) GTEST_SKIP() << "not on this processor";
  const ImageBuffer image = testing::draw(131, 40, testing::TissueTexture(5));
  ImageBuffer a(131, 40), b(131, 40);
  BinomialSmoothing(131)(image, a, SimdPath::Portable);
  BinomialSmoothing(131)(image, b, SimdPath::Avx2);
  expectSamePixels(a, b);
}

}  // namespace
}  // namespace depthscope::slam
