#include "platform/ar/steady_view.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

ViewOutline uniform(float left, float right) {
  ViewOutline view;
  view.spans.fill({left, right});
  return view;
}

PoseEstimate trackedAt(double time_s) {
  PoseEstimate estimate;
  estimate.timestamp_s = time_s;
  estimate.state = TrackingState::Tracking;
  return estimate;
}

TEST(SteadyView, WhatIsLitBelongsToItAtOnce) {
  SteadyView steady;
  EXPECT_TRUE(steady.add(uniform(50, 200), trackedAt(0)));
  EXPECT_FALSE(steady.add(uniform(60, 190), trackedAt(0.1))) << "dark tissue at the border";
  EXPECT_EQ(steady.view(), uniform(50, 200));
  EXPECT_TRUE(steady.add(uniform(40, 180), trackedAt(0.2)));
  EXPECT_EQ(steady.view(), uniform(40, 200));
}

TEST(SteadyView, WhatStaysDarkForLongDoesNot) {
  SteadyView steady;
  steady.add(uniform(40, 210), trackedAt(0));
  int changes = 0;
  double changed_s = 0;
  for (int i = 1; i < 600; ++i)
    if (steady.add(uniform(50, 200), trackedAt(i / 30.0))) ++changes, changed_s = i / 30.0;
  EXPECT_EQ(changes, 1);
  EXPECT_GE(changed_s, SteadyView::remembered_s);
  EXPECT_LE(changed_s, 2 * SteadyView::remembered_s + 0.1);
  EXPECT_EQ(steady.view(), uniform(50, 200));
}

TEST(SteadyView, ADarkPictureChangesNothingForAWhileAndLightComesBackAtOnce) {
  SteadyView steady;
  steady.add(uniform(50, 200), trackedAt(0));
  const ViewOutline dark = uniform(0, 0);
  EXPECT_FALSE(steady.add(dark, trackedAt(1)));
  for (int i = 2; i < 30; ++i) steady.add(dark, trackedAt(i));
  EXPECT_TRUE(steady.view().spans[0].empty());
  EXPECT_TRUE(steady.add(uniform(50, 200), trackedAt(31)));
  EXPECT_EQ(steady.view(), uniform(50, 200));
}

TEST(SteadyView, WhatALostScopeSeesDoesNotBelongToIt) {
  SteadyView steady;
  steady.add(uniform(50, 200), trackedAt(0));
  PoseEstimate lost = trackedAt(0.1);
  lost.state = TrackingState::Lost;
  EXPECT_FALSE(steady.add(uniform(20, 230), lost));
  EXPECT_EQ(steady.view(), uniform(50, 200));
}

}  // namespace
}  // namespace depthscope::platform
