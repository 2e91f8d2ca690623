#include "slam/corner_distribution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace depthscope::slam {
namespace {

constexpr int kWidth = 320, kHeight = 240;

Corner cornerAt(int x, int y, int score) {
  return {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
          static_cast<std::uint8_t>(score)};
}

bool isInPatch(int x, int y) {
  return x >= 20 && x < 140 && y >= 20 && y < 140;
}

/// Corners on distinct pixels: `dense` in a patch, `sparse` over the rest of the picture.
std::vector<Corner> unevenCorners(int dense, int sparse, unsigned seed) {
  std::mt19937 rng(seed);
  std::set<std::pair<int, int>> places;
  while (dense + sparse > 0) {
    const int x = static_cast<int>(rng() % kWidth), y = static_cast<int>(rng() % kHeight);
    int& left = isInPatch(x, y) ? dense : sparse;
    if (left > 0 && places.emplace(y, x).second) --left;
  }
  std::vector<Corner> corners;
  for (const auto& [y, x] : places)
    corners.push_back(cornerAt(x, y, 7 + static_cast<int>(rng() % 100)));
  return corners;
}

TEST(CornerDistribution, KeepsAsManyAsWanted) {
  CornerDistribution distribution(kWidth, kHeight, 4000);
  for (const int wanted : {0, 1, 2, 17, 100, 500, 1999, 2000}) {
    std::vector<Corner> corners = unevenCorners(1000, 1000, 1);
    distribution.reduce(wanted, kWidth, kHeight, corners);
    EXPECT_EQ(static_cast<int>(corners.size()), wanted);
  }
}

TEST(CornerDistribution, KeepsAllWhereThereAreNoMoreThanWanted) {
  CornerDistribution distribution(kWidth, kHeight, 4000);
  std::vector<Corner> corners = unevenCorners(20, 30, 2);
  distribution.reduce(100, kWidth, kHeight, corners);
  EXPECT_EQ(corners.size(), 50U);
}

TEST(CornerDistribution, SpreadsThem) {
  CornerDistribution distribution(kWidth, kHeight, 4000);
  std::vector<Corner> corners = unevenCorners(300, 100, 3);
  distribution.reduce(150, kWidth, kHeight, corners);
  const auto in_patch = std::count_if(corners.begin(), corners.end(),
                                      [](const Corner& c) { return isInPatch(c.x, c.y); });
  EXPECT_LT(in_patch, 95);  // of 112 in proportion
  double nearest_pair = 1e9;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      nearest_pair = std::min<double>(
          nearest_pair, std::hypot(corners[i].x - corners[j].x, corners[i].y - corners[j].y));
  EXPECT_GE(nearest_pair, 4);
}

TEST(CornerDistribution, PrefersTheStrongOfANeighbourhood) {
  CornerDistribution distribution(kWidth, kHeight, 100);
  std::vector<Corner> corners{cornerAt(100, 100, 20), cornerAt(102, 100, 90), cornerAt(98, 101, 30),
                              cornerAt(200, 50, 40), cornerAt(202, 52, 10)};
  distribution.reduce(2, kWidth, kHeight, corners);
  ASSERT_EQ(corners.size(), 2U);
  EXPECT_EQ(corners[0].x, 102);
  EXPECT_EQ(corners[1].x, 200);
}

TEST(CornerDistribution, OfEquallyStrongOnesTheFirstIsKept) {
  CornerDistribution distribution(kWidth, kHeight, 100);
  std::vector<Corner> corners{cornerAt(100, 100, 20), cornerAt(102, 100, 20),
                              cornerAt(104, 100, 20)};
  distribution.reduce(1, kWidth, kHeight, corners);
  ASSERT_EQ(corners.size(), 1U);
  EXPECT_EQ(corners[0].x, 100);
}

}  // namespace
}  // namespace depthscope::slam
