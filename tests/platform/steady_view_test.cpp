#include "platform/ar/steady_view.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

ViewOutline uniform(float left, float right) {
  ViewOutline view;
  view.spans.fill({left, right});
  return view;
}

TEST(SteadyView, WhatIsLitBelongsToItAtOnce) {
  SteadyView steady;
  EXPECT_TRUE(steady.add(uniform(50, 200), 0));
  EXPECT_FALSE(steady.add(uniform(60, 190), 0.1)) << "dark tissue at the border";
  EXPECT_EQ(steady.view(), uniform(50, 200));
  EXPECT_TRUE(steady.add(uniform(40, 180), 0.2));
  EXPECT_EQ(steady.view(), uniform(40, 200));
}

TEST(SteadyView, WhatStaysDarkForLongDoesNot) {
  SteadyView steady;
  steady.add(uniform(40, 210), 0);
  int changes = 0;
  double changed_s = 0;
  for (int i = 1; i < 600; ++i)
    if (steady.add(uniform(50, 200), i / 30.0)) ++changes, changed_s = i / 30.0;
  EXPECT_EQ(changes, 1);
  EXPECT_GE(changed_s, SteadyView::remembered_s);
  EXPECT_LE(changed_s, 2 * SteadyView::remembered_s + 0.1);
  EXPECT_EQ(steady.view(), uniform(50, 200));
}

TEST(SteadyView, ADarkPictureChangesNothingForAWhileAndLightComesBackAtOnce) {
  SteadyView steady;
  steady.add(uniform(50, 200), 0);
  const ViewOutline dark = uniform(0, 0);
  EXPECT_FALSE(steady.add(dark, 1));
  for (int i = 2; i < 30; ++i) steady.add(dark, i);
  EXPECT_TRUE(steady.view().spans[0].empty());
  EXPECT_TRUE(steady.add(uniform(50, 200), 31));
  EXPECT_EQ(steady.view(), uniform(50, 200));
}

}  // namespace
}  // namespace depthscope::platform
