#include "platform/surface_schedule.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

TEST(SurfaceSchedule, IsDueSoonAfterTheStartAndThenEveryPeriod) {
  SurfaceSchedule s(3.0);
  EXPECT_FALSE(s.due(10.0));
  EXPECT_FALSE(s.due(10.9));
  EXPECT_TRUE(s.due(11.0));
  EXPECT_TRUE(s.due(11.1));  // until it was asked for
  s.surfaceRequested(11.1);
  EXPECT_FALSE(s.due(14.0));
  EXPECT_TRUE(s.due(14.1));
}

TEST(SurfaceSchedule, WaitsNoLongerThanAShortPeriodAtTheStart) {
  SurfaceSchedule s(0.25);
  EXPECT_FALSE(s.due(0.0));
  EXPECT_TRUE(s.due(0.25));
}

TEST(SurfaceSchedule, IsNeverDueWithoutAPeriod) {
  SurfaceSchedule s(0);
  EXPECT_FALSE(s.due(0));
  EXPECT_FALSE(s.due(1e6));
}

TEST(SurfaceSchedule, StartsAnewInANewMap) {
  SurfaceSchedule s(3.0);
  s.due(0);
  s.surfaceRequested(1.0);
  s.restart();
  EXPECT_FALSE(s.due(2.0));
  EXPECT_TRUE(s.due(3.0));
}

}  // namespace
}  // namespace depthscope::platform
