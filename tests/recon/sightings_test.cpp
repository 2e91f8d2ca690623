#include "recon/sightings.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "rendered_views.hpp"

namespace depthscope::recon {
namespace {

bool sees(const std::vector<Sighting>& sightings, std::uint32_t point, std::uint32_t view) {
  return std::any_of(sightings.begin(), sightings.end(),
                     [&](const Sighting& s) { return s.point == point && s.view == view; });
}

/// One point in front of a keyframe at the origin, and another view.
SparseCloud onePointAnd(const Eigen::Vector3d& centre, float point_x = 0) {
  SparseCloud cloud;
  cloud.points.push_back({{point_x, 0, 4}, {0, 0, -1}, 2, 0});
  cloud.keyframes = 1;
  Pose other;
  other.t = -centre;
  cloud.views_T_camera_world = {Pose{}, other};
  cloud.view_frames = {0, 5};
  cloud.sightings = {{0, 0}};
  return cloud;
}

const PinholeLevel kLevel{320, 240, 300, 159.5f, 119.5f};

TEST(Sightings, AViewSeesWhatAKeyframeSawFromNearby) {
  const auto sightings = sightingsOfAllViews(onePointAnd({0.5, 0, 0}), kLevel);
  EXPECT_TRUE(sees(sightings, 0, 0));
  EXPECT_TRUE(sees(sightings, 0, 1));
}

TEST(Sightings, FromAnotherDirectionOrDistanceSomethingMayStandBetween) {
  EXPECT_FALSE(sees(sightingsOfAllViews(onePointAnd({1.8, 0, 0}), kLevel), 0, 1));  // 24 degrees
  EXPECT_FALSE(sees(sightingsOfAllViews(onePointAnd({0, 0, 2}), kLevel), 0, 1));    // half as far
  EXPECT_FALSE(sees(sightingsOfAllViews(onePointAnd({0, 0, -3}), kLevel), 0, 1));
}

TEST(Sightings, WhatLiesOutsideThePictureOrBehindIsNotSeen) {
  EXPECT_FALSE(sees(sightingsOfAllViews(onePointAnd({0.4, 0, 0}, -2), kLevel), 0, 1));
  EXPECT_FALSE(sees(sightingsOfAllViews(onePointAnd({0, 0, 8}), kLevel), 0, 1));
}

TEST(Sightings, ArePointByPointAndThoseOfKeyframesStay) {
  RenderedViews scene = renderViews([](float, float) { return 0.f; }, 5);
  const auto all = sightingsOfAllViews(scene.cloud, kLevel);
  EXPECT_EQ(all.size(), scene.cloud.sightings.size());
  scene.cloud.keyframes = 2;
  std::erase_if(scene.cloud.sightings, [](const Sighting& s) { return s.view >= 2; });
  const auto derived = sightingsOfAllViews(scene.cloud, kLevel);
  EXPECT_GT(derived.size(), scene.cloud.sightings.size());
  EXPECT_TRUE(std::is_sorted(derived.begin(), derived.end(),
                             [](const auto& a, const auto& b) { return a.point < b.point; }));
}

}  // namespace
}  // namespace depthscope::recon
