// Maps that are adjusted as a whole: by itself, and by the mapper now and then.
#include <gtest/gtest.h>

#include <algorithm>

#include "slam/global_bundle.hpp"
#include "slam/mapper.hpp"
#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

constexpr int kKeyframes = 8;

/// Keyframes and points of a map, each put a little off.
class DisturbedMap : public ::testing::Test {
 protected:
  DisturbedMap() {
    for (PointId p = 0; p < map().pointEnd(); ++p) map().point(p).position += shake(0.03);
    for (int i = 1; i < kKeyframes; ++i) {
      Pose& T = keyframe(i).T_camera_world;
      T = T.retract(shake(0.01), shake(0.01));
    }
  }

  Eigen::Vector3d shake(double size) {
    return {uniform(rng_, -size, size), uniform(rng_, -size, size), uniform(rng_, -size, size)};
  }

  Map& map() { return mapped_.map; }
  Keyframe& keyframe(int i) { return map().keyframe(mapped_.keyframes[i]); }

  /// Mean distance of the first `n` keyframes from the oldest.
  double extent(int n) {
    const Eigen::Vector3d oldest = keyframe(0).T_camera_world.inverse().t;
    double sum = 0;
    for (int i = 1; i < n; ++i) sum += (keyframe(i).T_camera_world.inverse().t - oldest).norm();
    return sum / (n - 1);
  }

  /// Mean reprojection error of the first `n` keyframes [px].
  double reprojectionError(int n) {
    double sum = 0;
    int observations = 0;
    for (int i = 0; i < n; ++i) {
      const Keyframe& k = keyframe(i);
      for (int f = 0; f < k.features.size(); ++f) {
        if (k.points[f] == kNone) continue;
        const Keypoint& kp = k.features.keypoints[f];
        const Eigen::Vector3d p = k.T_camera_world * map().point(k.points[f]).position;
        sum += (testCamera().project(p) - Eigen::Vector2d(kp.ux, kp.uy)).norm();
        ++observations;
      }
    }
    return sum / observations;
  }

  World world_{400};
  std::vector<Pose> truth_ = sidewaysPoses(kKeyframes);
  MappedWorld mapped_{smallSettings(), world_, truth_};
  std::mt19937 rng_{7};
};

TEST_F(DisturbedMap, IsConsistentAfterwardsAndAsLargeAndWhereItWas) {
  const Pose oldest = keyframe(0).T_camera_world;
  const double before = extent(kKeyframes);
  ASSERT_GT(reprojectionError(kKeyframes), 1);
  BundleAdjuster adjuster(12, 1000, 12000);
  GlobalBundle bundle(smallSettings(), map(), adjuster);
  EXPECT_NE(bundle.adjust(map().activeId(), 30, nullptr).end, BaSummary::End::Failed);
  EXPECT_LT(reprojectionError(kKeyframes), 0.02);
  EXPECT_NEAR(extent(kKeyframes), before, 1e-6 * before);
  EXPECT_LT((keyframe(0).T_camera_world.t - oldest.t).norm(), 1e-9);
  EXPECT_LT((keyframe(0).T_camera_world.R - oldest.R).norm(), 1e-9);
}

TEST_F(DisturbedMap, IsNotTakenForLargerForTheSakeOfAPointFarAway) {
  const Keyframe& first = keyframe(0);
  const auto seen =
      std::find_if(first.points.begin(), first.points.end(), [](PointId p) { return p != kNone; });
  ASSERT_NE(seen, first.points.end());
  MapPoint& point = map().point(*seen);
  const Eigen::Vector3d centre = first.T_camera_world.inverse().t;
  point.position = centre + 1e4 * (point.position - centre);
  BundleAdjuster adjuster(12, 1000, 12000);
  GlobalBundle bundle(smallSettings(), map(), adjuster);
  bundle.adjust(map().activeId(), 30, nullptr);
  for (int i = 0; i < kKeyframes; ++i) EXPECT_NEAR(keyframe(i).unit, 1, 0.05);
}

/// A night's worth of adjustments: what rounding does to a rotation must not add up, let alone
/// multiply, in the one keyframe whose pose no adjustment determines anew.
TEST_F(DisturbedMap, StaysWhereItIsHoweverOftenItIsAdjusted) {
  const Sim3 turn = expSim3((Vector7d() << 0.4, -0.3, 0.2, 0, 0, 0, 0).finished());
  for (const KeyframeId k : mapped_.keyframes) map().moveKeyframe(k, turn);
  for (PointId p = 0; p < map().pointEnd(); ++p) map().movePoint(p, turn);
  const Pose oldest = keyframe(0).T_camera_world;
  BundleAdjuster adjuster(12, 1000, 12000);
  GlobalBundle bundle(smallSettings(), map(), adjuster);
  for (int n = 0; n < 100; ++n) {
    for (int i = 1; i < kKeyframes; ++i) {
      Pose& T = keyframe(i).T_camera_world;
      T = T.retract(shake(0.001), shake(0.001));
    }
    ASSERT_GT(bundle.adjust(map().activeId(), 5, nullptr).iterations, 0);
  }
  EXPECT_LT(reprojectionError(kKeyframes), 0.1);
  EXPECT_LT((keyframe(0).T_camera_world.R - oldest.R).norm(), 1e-9);
  EXPECT_LT((keyframe(0).T_camera_world.t - oldest.t).norm(), 1e-9);
  const Eigen::Matrix3d R = map().correction().R;
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST_F(DisturbedMap, IsLeftAloneWhereItIsNone) {
  BundleAdjuster adjuster(12, 1000, 12000);
  GlobalBundle bundle(smallSettings(), map(), adjuster);
  EXPECT_EQ(bundle.adjust(map().activeId() + 1, 30, nullptr).end, BaSummary::End::Failed);
}

/// A mapper whose window reaches no farther than two keyframes, so that what is wrong at the other
/// end of the map is beyond it.
class NarrowMapper : public DisturbedMap {
 protected:
  /// Reprojection error at the far end after `keyframes` more at the near one.
  double farErrorAfter(int keyframes, int whole_map_every) {
    SlamSettings settings = smallSettings();
    settings.capacity.keyframes = 24;
    settings.mapper.window_keyframes = 2;
    settings.mapper.window_fixed = 2;
    settings.mapper.redundancy = 1;  // keyframes alike are kept
    settings.mapper.whole_map_every = whole_map_every;
    Mapper mapper(settings, testCameraModel(), map(), database_, records_, MappingMode::Lockstep);
    for (int n = 0; n < keyframes; ++n) {
      const Pose pose = cameraAt({0.3 * (kKeyframes - 1) + 0.02 * (n + 1), 0, 0}, {0, 0, 0});
      std::vector<int> ids;
      const FeatureSet features = world_.view(pose, ids);
      std::vector<PointRef> points;
      for (const int id : ids)
        points.push_back(mapped_.point_of[id] == kNone ? PointRef{}
                                                       : map().ref(mapped_.point_of[id]));
      mapper.submit(features, points, pose, map().correction(), 100 + n, n);
    }
    return reprojectionError(3);
  }

  KeyframeDatabase database_{smallSettings(), Vocabulary::builtIn()};
  FrameRecords records_{Trajectory(0), ViewKeeper(0, 1)};
};

TEST_F(NarrowMapper, AdjustsTheWholeMapNowAndThen) {
  EXPECT_LT(farErrorAfter(3, 3), 0.5);
}

TEST_F(NarrowMapper, DoesNotBeforeItIsTime) {
  EXPECT_GT(farErrorAfter(2, 3), 1);
}

TEST_F(NarrowMapper, NeverDoesWhereItIsSwitchedOff) {
  EXPECT_GT(farErrorAfter(3, 0), 1);
}

}  // namespace
}  // namespace depthscope::slam
