#include "slam/map.hpp"

#include <gtest/gtest.h>

#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

TEST(Map, KeepsObservationsTheSameFromBothSides) {
  const World world(200);
  MappedWorld m(smallSettings(), world, sidewaysPoses(3));
  for (PointId p = 0; p < m.map.pointEnd(); ++p)
    for (const Observation& o : m.map.observations(p))
      EXPECT_EQ(m.map.keyframe(o.keyframe).points[o.feature], p);
}

TEST(Map, RefusesASecondPointOnAFeatureAndASecondFeatureForAPoint) {
  const World world(50);
  MappedWorld m(smallSettings(), world, sidewaysPoses(2));
  const PointId other = m.map.addPoint({0, 0, 5}, 0);
  const Observation taken = m.map.observations(m.point_of[0])[0];
  EXPECT_FALSE(m.map.observe(other, taken.keyframe, taken.feature));
  EXPECT_FALSE(m.map.observe(m.point_of[0], taken.keyframe, taken.feature + 1));
}

TEST(Map, APointLeftWithOneObserverGoes) {
  const World world(50);
  MappedWorld m(smallSettings(), world, sidewaysPoses(2));
  const int before = m.map.pointCount();
  ASSERT_GT(before, 20);
  m.map.removeKeyframe(m.keyframes[0]);
  EXPECT_EQ(m.map.pointCount(), 0);
  for (const PointId p : m.map.keyframe(m.keyframes[1]).points) EXPECT_EQ(p, kNone);
}

TEST(Map, AReferenceFollowsAMergeAndDiesWithItsPoint) {
  const World world(50);
  MappedWorld m(smallSettings(), world, sidewaysPoses(3));
  const PointRef merged = m.map.ref(m.point_of[0]), into = m.map.ref(m.point_of[1]);
  m.map.mergePoints(merged.id, into.id);
  EXPECT_EQ(m.map.resolve(merged), into.id);
  m.map.removePoint(into.id);
  EXPECT_EQ(m.map.resolve(merged), kNone);
  EXPECT_EQ(m.map.resolve(into), kNone);
}

TEST(Map, AReferenceIsNotFooledByASlotUsedAgain) {
  const World world(50);
  MappedWorld m(smallSettings(), world, sidewaysPoses(2));
  const PointRef old = m.map.ref(m.point_of[0]);
  m.map.removePoint(old.id);
  PointId again;
  do again = m.map.addPoint({0, 0, 5}, 1);
  while (again != old.id && again != kNone);
  ASSERT_EQ(again, old.id);
  EXPECT_EQ(m.map.resolve(old), kNone);
  EXPECT_EQ(m.map.resolve(m.map.ref(again)), again);
}

TEST(Map, SaysWhenItIsFullAndGrowsNoFurther) {
  SlamSettings settings = smallSettings();
  settings.capacity.keyframes = 3;
  settings.capacity.map_points = 10;
  Map map(settings, testCameraModel());
  const FeatureSet none(400, testCameraModel());
  for (int i = 0; i < 3; ++i) EXPECT_NE(map.addKeyframe(none, Pose{}, i, i), kNone);
  EXPECT_EQ(map.freeKeyframes(), 0);
  EXPECT_EQ(map.addKeyframe(none, Pose{}, 3, 3), kNone);
  for (int i = 0; i < 10; ++i) EXPECT_NE(map.addPoint({0, 0, 1}, 0), kNone);
  EXPECT_EQ(map.addPoint({0, 0, 1}, 0), kNone);
}

TEST(Map, AFullPointTakesNoMoreObservers) {
  SlamSettings settings = smallSettings();
  settings.capacity.observations_per_point = 2;
  const World world(50);
  MappedWorld m(settings, world, sidewaysPoses(3, 0.05));
  for (PointId p = 0; p < m.map.pointEnd(); ++p) EXPECT_EQ(m.map.observations(p).size(), 2u);
}

TEST(Map, CountsSharedPointsOfEveryOtherKeyframe) {
  const World world(100);
  MappedWorld m(smallSettings(), world, sidewaysPoses(2));
  std::vector<int> votes(m.map.keyframeCapacity());
  m.map.countShared(m.keyframes[0], votes);
  EXPECT_EQ(votes[m.keyframes[1]], m.map.pointCount());
  EXPECT_EQ(votes[m.keyframes[0]], 0);
}

TEST(Map, RescaleLeavesEveryProjectionInPlace) {
  const World world(100);
  MappedWorld m(smallSettings(), world, sidewaysPoses(3));
  const PointId p = m.point_of[5];
  const Keyframe& k = m.map.keyframe(m.keyframes[2]);
  const Eigen::Vector2d before = testCamera().project(k.T_camera_world * m.map.point(p).position);
  const double depth = m.map.medianDepth(m.keyframes[2]);
  m.map.keyframe(m.keyframes[2]).twist = {{0.1, 0.2, 0.3}, {4, 8, 12}};
  m.map.rescale(0.25);
  EXPECT_EQ(k.twist.w, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(k.twist.v, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR((testCamera().project(k.T_camera_world * m.map.point(p).position) - before).norm(), 0,
              1e-9);
  EXPECT_NEAR(m.map.medianDepth(m.keyframes[2]), 0.25 * depth, 1e-12);
}

TEST(Map, ClearingInvalidatesEveryReference) {
  const World world(50);
  MappedWorld m(smallSettings(), world, sidewaysPoses(2));
  const PointRef ref = m.map.ref(m.point_of[0]);
  const auto id = m.map.activeId();
  m.map.clear();
  EXPECT_EQ(m.map.resolve(ref), kNone);
  m.map.start();
  EXPECT_NE(m.map.activeId(), id);
  EXPECT_EQ(m.map.keyframeCount() + m.map.pointCount(), 0);
}

}  // namespace
}  // namespace depthscope::slam
