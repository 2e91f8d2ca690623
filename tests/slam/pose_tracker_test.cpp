#include "slam/pose_tracker.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

TEST(PoseTracker, FindsAPointInOneFeatureOnly) {
  const SlamSettings settings = smallSettings();
  const World world(150);
  const auto poses = sidewaysPoses(3);
  MappedWorld mapped(settings, world, poses);
  PoseTracker tracker(testCameraModel(), settings, mapped.map);

  // Every feature twice, half a pixel apart; the first of each is known already.
  TrackedFrame frame(settings.extractor.features, testCameraModel());
  std::vector<int> ids;
  frame.features = world.view(poses[1], ids);
  frame.T_camera_world = poses[1];
  const int seen = frame.features.size();
  int known = 0;
  for (int f = 0; f < seen; ++f) {
    Keypoint double_of = frame.features.keypoints[f];
    double_of.x = double_of.ux += 0.5F;
    frame.features.keypoints.push_back(double_of);
    frame.features.descriptors.push_back(frame.features.descriptors[f]);
    if (const PointId p = mapped.point_of[ids[f]]; p != kNone) {
      frame.points[f] = mapped.map.ref(p);
      ++known;
    }
  }
  ASSERT_LE(frame.features.size(), settings.extractor.features);
  frame.features.grid.build(frame.features.keypoints);

  const int inliers = tracker.trackLocalMap(frame);
  EXPECT_EQ(inliers, known);
  std::multiset<PointId> points;
  for (int f = 0; f < frame.features.size(); ++f)
    if (frame.points[f].id != kNone) points.insert(frame.points[f].id);
  for (const PointId p : points) EXPECT_EQ(points.count(p), 1u);
}

int foundByChanceIn(const World& world) {
  const SlamSettings settings = smallSettings();
  const auto poses = sidewaysPoses(3);
  MappedWorld mapped(settings, world, poses);
  PoseTracker tracker(testCameraModel(), settings, mapped.map);
  TrackedFrame frame(settings.extractor.features, testCameraModel());
  std::vector<int> ids;
  frame.features = world.view(poses[1], ids);
  frame.T_camera_world = poses[1];
  for (int f = 0; f < frame.features.size(); ++f)
    if (const PointId p = mapped.point_of[ids[f]]; p != kNone) frame.points[f] = mapped.map.ref(p);
  EXPECT_GT(tracker.trackLocalMap(frame), 100);
  return tracker.foundByChance(frame);
}

TEST(PoseTracker, TellsWhatWouldBeFoundByChance) {
  World world(400);
  EXPECT_EQ(foundByChanceIn(world), 0);
  // All points look the same: where two lie as far apart as is looked beside, one passes for the
  // other.
  for (Descriptor& d : world.descriptors) d = world.descriptors.front();
  EXPECT_GT(foundByChanceIn(world), 2);
}

TEST(PoseTracker, PointsThatDoNotStandStillLoseTrust) {
  const SlamSettings settings = smallSettings();
  const World world(300);
  const auto poses = sidewaysPoses(3);
  MappedWorld mapped(settings, world, poses);
  PoseTracker tracker(testCameraModel(), settings, mapped.map);
  const auto moves = [](int point) { return point % 4 == 0; };

  TrackedFrame frame(settings.extractor.features, testCameraModel());
  std::vector<int> ids;
  for (int i = 0; i < 60; ++i) {
    frame.features = world.view(poses[1], ids);
    frame.T_camera_world = poses[1];
    for (int f = 0; f < frame.features.size(); ++f) {
      const PointId p = mapped.point_of[ids[f]];
      frame.points[f] = p == kNone ? PointRef{} : mapped.map.ref(p);
      if (!moves(ids[f])) continue;
      Keypoint& k = frame.features.keypoints[f];
      k.ux += (ids[f] / 4 + i) % 2 == 0 ? 2.f * k.sigma : -2.f * k.sigma;
    }
    frame.features.grid.build(frame.features.keypoints);
    ASSERT_GT(tracker.trackLocalMap(frame), 100);
  }
  for (const int point : ids) {
    const PointId p = mapped.point_of[point];
    if (p == kNone) continue;
    if (moves(point))
      EXPECT_LT(mapped.map.point(p).trust(), 0.6f) << point;
    else
      EXPECT_EQ(mapped.map.point(p).trust(), 1.f) << point;
  }
}

}  // namespace
}  // namespace depthscope::slam
