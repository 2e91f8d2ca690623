#include "slam/fast_detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include "tests/slam/tissue_picture.hpp"

namespace depthscope::slam {
namespace {

constexpr Area kAll{4, 4, 93, 61};  // of pictures of 97 x 65

/// The definition, word for word.
int scoreByDefinition(const ImageBuffer& image, int x, int y) {
  constexpr std::array<std::array<int, 2>, 16> kCircle{{{0, -3},
                                                        {1, -3},
                                                        {2, -2},
                                                        {3, -1},
                                                        {3, 0},
                                                        {3, 1},
                                                        {2, 2},
                                                        {1, 3},
                                                        {0, 3},
                                                        {-1, 3},
                                                        {-2, 2},
                                                        {-3, 1},
                                                        {-3, 0},
                                                        {-3, -1},
                                                        {-2, -2},
                                                        {-1, -3}}};
  int best = 0;
  for (int start = 0; start < 16; ++start) {
    int brighter = 255, darker = 255;
    for (int k = start; k < start + 9; ++k) {
      const int difference =
          image.row(y + kCircle[k % 16][1])[x + kCircle[k % 16][0]] - image.row(y)[x];
      brighter = std::min(brighter, difference);
      darker = std::min(darker, -difference);
    }
    best = std::max({best, brighter, darker});
  }
  return best;
}

std::vector<Corner> cornersByDefinition(const ImageBuffer& image, int threshold, const Area& area) {
  const auto score = [&](int x, int y) {
    const int s = scoreByDefinition(image, x, y);
    return s > threshold ? s : 0;
  };
  std::vector<Corner> corners;
  for (int y = area.top; y < area.bottom; ++y)
    for (int x = area.left; x < area.right; ++x) {
      const int s = score(x, y);
      bool maximum = s > 0;
      for (int v = -1; v <= 1 && maximum; ++v)
        for (int u = -1; u <= 1 && maximum; ++u) {
          const bool before = v < 0 || (v == 0 && u < 0);
          if (u != 0 || v != 0)
            maximum = before ? s > score(x + u, y + v) : s >= score(x + u, y + v);
        }
      if (maximum)
        corners.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                           static_cast<std::uint8_t>(s)});
    }
  return corners;
}

std::vector<Corner> detect(const ImageBuffer& image, int threshold, const Area& area,
                           SimdPath path) {
  FastDetector detector(image.width());
  std::vector<Corner> corners;
  detector.detect(image, threshold, area, path, corners);
  return corners;
}

void expectSame(const std::vector<Corner>& found, const std::vector<Corner>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].x, expected[i].x);
    EXPECT_EQ(found[i].y, expected[i].y);
    EXPECT_EQ(found[i].score, expected[i].score);
  }
}

ImageBuffer randomPicture(unsigned seed, int levels) {
  std::mt19937 rng(seed);
  return testing::draw(97, 65, [&](double, double) { return rng() % levels * 255 / (levels - 1); });
}

class FastDetectorPaths : public ::testing::TestWithParam<SimdPath> {
 protected:
  void SetUp() override {
    if (!isAvailable(GetParam())) GTEST_SKIP() << "not on this processor";
  }
};

TEST_P(FastDetectorPaths, FindsTheCornersOfTheDefinitionInTexture) {
  const ImageBuffer image = testing::draw(97, 65, testing::TissueTexture(1));
  for (const int threshold : {1, 6, 20}) {
    const std::vector<Corner> expected = cornersByDefinition(image, threshold, kAll);
    EXPECT_FALSE(expected.empty());
    expectSame(detect(image, threshold, kAll, GetParam()), expected);
  }
}

TEST_P(FastDetectorPaths, FindsTheCornersOfTheDefinitionInNoiseOfFullContrast) {
  for (const int levels : {2, 3, 256})
    expectSame(detect(randomPicture(5, levels), 40, kAll, GetParam()),
               cornersByDefinition(randomPicture(5, levels), 40, kAll));
}

TEST_P(FastDetectorPaths, LooksOnlyInTheAreaGiven) {
  const ImageBuffer image = testing::draw(97, 65, testing::TissueTexture(2));
  const Area area{17, 20, 54, 37};
  expectSame(detect(image, 3, area, GetParam()), cornersByDefinition(image, 3, area));
  EXPECT_TRUE(detect(image, 3, {20, 20, 20, 40}, GetParam()).empty());
}

INSTANTIATE_TEST_SUITE_P(AllPaths, FastDetectorPaths,
                         ::testing::Values(SimdPath::Portable, SimdPath::Avx2));

}  // namespace
}  // namespace depthscope::slam
