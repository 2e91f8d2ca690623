#include "platform/histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace depthscope::platform {
namespace {

TEST(Histogram, IsEmptyAtFirst) {
  const Histogram h;
  EXPECT_EQ(h.count(), 0u);
  EXPECT_EQ(h.percentile(0.5), 0);
  EXPECT_EQ(h.max(), 0);
}

TEST(Histogram, KnowsPercentilesToOnePercent) {
  Histogram h;
  for (int i = 1; i <= 1000; ++i) h.add(i * 0.1);
  EXPECT_EQ(h.count(), 1000u);
  EXPECT_NEAR(h.percentile(0.5), 50, 0.5);
  EXPECT_NEAR(h.percentile(0.95), 95, 0.95);
  EXPECT_NEAR(h.percentile(0.99), 99, 0.99);
  EXPECT_EQ(h.max(), 100);
}

TEST(Histogram, NeverSaysMoreThanTheMaximum) {
  Histogram h;
  h.add(7.0);
  EXPECT_NEAR(h.percentile(0.01), 7, 0.07);
  EXPECT_LE(h.percentile(1.0), 7.0);
}

TEST(Histogram, TakesExtremesAndLeavesOutWhatIsNoNumber) {
  Histogram h;
  h.add(0);
  h.add(-1);
  h.add(1e12);
  h.add(NAN);
  h.add(INFINITY);
  EXPECT_EQ(h.count(), 3u);
  EXPECT_EQ(h.max(), 1e12);
}

}  // namespace
}  // namespace depthscope::platform
