#include "types/surroundings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace depthscope {
namespace {

constexpr int kWidth = 200, kHeight = 120, kMost = 24;

/// A round view of tissue between `dark` and `bright`, in surroundings of the level `black`.
struct RoundView {
  std::vector<std::uint8_t> pixels;

  RoundView(double radius, int black, int dark, int bright) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool seen = std::hypot(x - kWidth / 2, y - kHeight / 2) < radius;
        pixels.push_back(
            static_cast<std::uint8_t>(seen ? dark + (bright - dark) * x / kWidth : black));
      }
  }
  int limit(int most) const {
    return surroundingsLimit({pixels.data(), kWidth, kHeight, kWidth}, most);
  }
};

TEST(Surroundings, OfABrightViewMayGlow) {
  EXPECT_GT(RoundView(55, 0, 60, 220).limit(kMost), 20);
  EXPECT_EQ(RoundView(55, 16, 60, 220).limit(kMost), kMost);
}

TEST(Surroundings, OfADimViewAreDarkerThanItsTissue) {
  const int limit = RoundView(55, 1, 8, 40).limit(kMost);
  EXPECT_GE(limit, 1);
  EXPECT_LT(limit, 8);
}

TEST(Surroundings, AreTheWholePictureWhereNothingIsLit) {
  EXPECT_EQ(RoundView(55, 3, 3, 3).limit(kMost), 3);
}

TEST(Surroundings, OfADimPictureWithoutARoundViewAreFewOfItsPixels) {
  const RoundView full(1000, 0, 8, 40);
  const int limit = full.limit(kMost);
  const auto taken = std::count_if(full.pixels.begin(), full.pixels.end(),
                                   [&](std::uint8_t p) { return p <= limit; });
  EXPECT_LT(taken, kWidth * kHeight / 5);
}

TEST(Surroundings, AreNowhereWhereTheSettingSaysSo) {
  EXPECT_EQ(RoundView(55, 0, 60, 220).limit(-1), -1);
}

}  // namespace
}  // namespace depthscope
