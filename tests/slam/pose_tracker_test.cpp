#include "slam/pose_tracker.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// A world mapped from three places, and a frame taken at the middle one.
struct SeenWorld {
  const World& world;
  SlamSettings settings = smallSettings();
  std::vector<Pose> poses = sidewaysPoses(3);
  MappedWorld mapped{settings, world, poses};
  PoseTracker tracker{testCameraModel(), settings, mapped.map};
  TrackedFrame frame{settings.extractor.features, testCameraModel()};
  std::vector<int> ids;  // per feature of the frame, the world's point

  explicit SeenWorld(const World& seen) : world(seen) {}
  /// Makes the frame anew; how many map points it shows, which it is told.
  int look() {
    frame.features = world.view(poses[1], ids);
    frame.T_camera_world = poses[1];
    int known = 0;
    for (int f = 0; f < frame.features.size(); ++f) {
      const PointId p = mapped.point_of[ids[f]];
      frame.points[f] = p == kNone ? PointRef{} : mapped.map.ref(p);
      known += p != kNone;
    }
    return known;
  }
};

TEST(PoseTracker, FindsAPointInOneFeatureOnly) {
  const World world(150);
  SeenWorld s(world);
  const int known = s.look();
  // Every feature twice, half a pixel apart; the first of each is known already.
  FeatureSet& features = s.frame.features;
  for (int f = 0, seen = features.size(); f < seen; ++f) {
    Keypoint double_of = features.keypoints[f];
    double_of.x = double_of.ux += 0.5F;
    features.keypoints.push_back(double_of);
    features.descriptors.push_back(features.descriptors[f]);
  }
  ASSERT_LE(features.size(), s.settings.extractor.features);
  features.grid.build(features.keypoints);

  EXPECT_EQ(s.tracker.trackLocalMap(s.frame), known);
  std::multiset<PointId> points;
  for (int f = 0; f < features.size(); ++f)
    if (s.frame.points[f].id != kNone) points.insert(s.frame.points[f].id);
  for (const PointId p : points) EXPECT_EQ(points.count(p), 1u);
}

TEST(PoseTracker, TellsWhatWouldBeFoundByChance) {
  const auto found_by_chance = [](const World& world) {
    SeenWorld s(world);
    s.look();
    EXPECT_GT(s.tracker.trackLocalMap(s.frame), 100);
    return s.tracker.foundByChance(s.frame);
  };
  World world(400);
  EXPECT_EQ(found_by_chance(world), 0);
  // All points look the same: where two lie as far apart as is looked beside, one passes for the
  // other.
  for (Descriptor& d : world.descriptors) d = world.descriptors.front();
  EXPECT_GT(found_by_chance(world), 2);
}

TEST(PoseTracker, PointsThatDoNotStandStillLoseTrust) {
  const World world(300);
  SeenWorld s(world);
  const auto moves = [](int point) { return point % 4 == 0; };
  for (int i = 0; i < 60; ++i) {
    s.look();
    for (int f = 0; f < s.frame.features.size(); ++f) {
      if (!moves(s.ids[f])) continue;
      Keypoint& k = s.frame.features.keypoints[f];
      k.ux += (s.ids[f] / 4 + i) % 2 == 0 ? 2.5f * k.sigma : -2.5f * k.sigma;
    }
    s.frame.features.grid.build(s.frame.features.keypoints);
    ASSERT_GT(s.tracker.trackLocalMap(s.frame), 100);
  }
  for (const int point : s.ids) {
    const PointId p = s.mapped.point_of[point];
    if (p == kNone) continue;
    if (moves(point))
      EXPECT_LT(s.mapped.map.point(p).trust(), 0.6f) << point;
    else
      EXPECT_EQ(s.mapped.map.point(p).trust(), 1.f) << point;
  }
}

/// The mapper may take points away while a frame is tracked.
TEST(PoseTracker, PointsThatAreGoneFromTheMapAreTakenFromTheFrame) {
  const World world(300);
  SeenWorld s(world);
  s.look();
  ASSERT_GT(s.tracker.trackLocalMap(s.frame), 100);
  const auto has_point = [&](int f) { return s.frame.points[f].id != kNone; };
  int removed = 0;
  for (int f = 0; f < s.frame.features.size() && removed < 20; ++f)
    if (has_point(f)) s.mapped.map.removePoint(s.frame.points[f].id), ++removed;
  const auto count = [&] {
    int n = 0;
    for (int f = 0; f < s.frame.features.size(); ++f) n += has_point(f);
    return n;
  };
  const int before = count();
  EXPECT_EQ(s.tracker.trackOwnPoints(s.frame), before - removed);
  EXPECT_EQ(count(), before - removed);
}

/// An instrument over a part of the picture, some of whose points were mapped while it lay still.
TEST(PoseTracker, WhatIsKnownForLongHoldsThePoseWhereNewPointsMoveTogether) {
  const auto off = [](float residual_of_known) {
    const World world(300);
    SeenWorld s(world);
    s.look();
    for (int f = 0; f < s.frame.features.size(); ++f) {
      const PointId p = s.mapped.point_of[s.ids[f]];
      if (p == kNone) continue;
      Keypoint& k = s.frame.features.keypoints[f];
      if (s.ids[f] % 5 < 2)
        k.ux += 1.6f * k.sigma;  // no outlier by itself
      else
        s.mapped.map.point(p).residual = residual_of_known;
    }
    s.frame.features.grid.build(s.frame.features.keypoints);
    EXPECT_GT(s.tracker.trackLocalMap(s.frame), 100);
    return (s.frame.T_camera_world.t - s.poses[1].t).norm();
  };
  const double all_new = off(MapPoint().residual);
  EXPECT_GT(all_new, 1e-3);
  EXPECT_LT(off(0.8f), 0.1 * all_new);
}

TEST(PoseTracker, NewPointsAloneTellThePoseAsSurelyAsOldOnes) {
  const auto covariance = [](float residual) {
    const World world(300);
    SeenWorld s(world);
    s.look();
    for (PointId p = 0; p < s.mapped.map.pointEnd(); ++p) s.mapped.map.point(p).residual = residual;
    for (int f = 0; f < s.frame.features.size(); ++f)
      s.frame.features.keypoints[f].ux += f % 2 == 0 ? 0.3f : -0.3f;
    EXPECT_GT(s.tracker.trackLocalMap(s.frame), 100);
    return s.frame.covariance.trace();
  };
  EXPECT_NEAR(covariance(6) / covariance(0.8f), 1, 1e-6);
}

}  // namespace
}  // namespace depthscope::slam
