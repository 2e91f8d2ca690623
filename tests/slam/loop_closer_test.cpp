#include "slam/loop_closer.hpp"

#include <gtest/gtest.h>

#include "slam/global_bundle.hpp"
#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_map.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

constexpr int kAround = 24, kKeyframes = 29;  // of a full turn, and a little more than one
constexpr int kSlipped = 14;                  // the first keyframe after a slip of scale

SlamSettings ringSettings() {
  SlamSettings s = smallSettings();
  s.capacity.keyframes = 32;
  s.capacity.map_points = 6000;
  s.capacity.local_points = 3000;
  return s;
}

/// Points all around, 4 to 6 away.
World ringWorld() {
  World world(0);
  std::mt19937 rng(8);
  for (int i = 0; i < 2400; ++i) {
    const double angle = uniform(rng, 0, 2 * std::numbers::pi), radius = uniform(rng, 4, 6);
    world.points.push_back(
        {radius * std::sin(angle), uniform(rng, -2, 2), radius * std::cos(angle)});
    world.descriptors.push_back(randomDescriptor(rng));
  }
  return world;
}

/// A map made by a camera that went once around, looking outwards, and drifted as it went: what its
/// last keyframes see it has mapped anew, elsewhere than its first keyframes have it.
class DriftedRing : public ::testing::Test {
 protected:
  /// The scale slips by `slip` half way around.
  explicit DriftedRing(double slip = 1) : slip_(slip) {
    map_.start();
    std::vector<std::vector<std::pair<int, int>>> seen(world_.points.size());
    for (int i = 0; i < kKeyframes; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      truth_.push_back(cameraAt({std::sin(angle), 0.02 * i, std::cos(angle)}, {0, angle, 0}));
      std::vector<int> ids;
      const FeatureSet features = world_.view(truth_[i], ids, 0.3);
      const KeyframeId k = map_.addKeyframe(features, drift(i).moved(truth_[i]), i, i);
      keyframes_.push_back(k);
      database_.add(map_, k);
      for (std::size_t f = 0; f < ids.size(); ++f) seen[ids[f]].push_back({i, static_cast<int>(f)});
    }
    for (std::size_t p = 0; p < seen.size(); ++p) {
      // Keyframes half a turn apart have made two points of one.
      const auto second = std::find_if(seen[p].begin(), seen[p].end(), [&](const auto& s) {
        return s.first > seen[p].front().first + kAround / 2;
      });
      addPoint(world_.points[p], {seen[p].begin(), second});
      addPoint(world_.points[p], {second, seen[p].end()});
    }
  }

  void addPoint(const Eigen::Vector3d& truth, const std::vector<std::pair<int, int>>& seen) {
    if (seen.size() < 2) return;
    const PointId p = map_.addPoint(drift(seen[seen.size() / 2].first) * truth, 0);
    for (const auto& [i, feature] : seen) map_.observe(p, keyframes_[i], feature);
    map_.refreshPoint(p);
  }

  Sim3 drift(int i) const {
    const Vector7d whole = (Vector7d() << 0.04, 0.08, -0.04, 0.3, 0.2, -0.3, 0.15).finished();
    const Sim3 steady = expSim3(whole * i / kKeyframes);
    if (i < kSlipped) return steady;
    const Eigen::Vector3d centre = truth_[kSlipped].inverse().t;
    return steady * Sim3{slip_, Eigen::Matrix3d::Identity(), (1 - slip_) * centre};
  }

  /// Of the keyframes' positions, after the best similarity to the truth.
  double largestError() {
    std::vector<Eigen::Vector3d> mine, truth;
    for (int i = 0; i < kKeyframes; ++i) {
      mine.push_back(map_.keyframe(keyframes_[i]).T_camera_world.inverse().t);
      truth.push_back(truth_[i].inverse().t);
    }
    Sim3 T_truth_mine;
    EXPECT_TRUE(alignPoints(mine, truth, T_truth_mine));
    double worst = 0;
    for (int i = 0; i < kKeyframes; ++i)
      worst = std::max(worst, (T_truth_mine * mine[i] - truth[i]).norm());
    return worst;
  }

  bool close(const PlaceLink& link) {
    return closer_.close(link, recognizer_.pairs(), recognizer_.window(),
                         std::vector<KeyframeId>(keyframes_.end() - 4, keyframes_.end() - 1));
  }

  double slip_;
  SlamSettings settings_ = ringSettings();
  World world_ = ringWorld();
  Map map_{settings_, testCameraModel()};
  KeyframeDatabase database_{settings_, Vocabulary::builtIn()};
  std::vector<Pose> truth_;
  std::vector<KeyframeId> keyframes_;
  PlaceRecognizer recognizer_{settings_, map_, database_};
  PointFuser fuser_{settings_, map_};
  MapMerger merger_{map_, fuser_};
  LoopCloser closer_{settings_, map_, merger_};
};

TEST_F(DriftedRing, IsClosed) {
  const double drifted = largestError();
  ASSERT_GT(drifted, 0.15);
  const auto link = recognizer_.recognize(keyframes_.back());
  ASSERT_TRUE(link);
  EXPECT_LT(map_.keyframe(link->before).serial, 8);

  const Pose T_before = map_.keyframe(link->before).T_camera_world;
  const Pose T_now_old = map_.keyframe(link->now).T_camera_world;
  const int points = map_.pointCount();
  ASSERT_TRUE(close(*link));

  EXPECT_LT(largestError(), 0.3 * drifted);
  EXPECT_LT(map_.pointCount(), points - 100);  // the two ends see the same ones now
  EXPECT_EQ(map_.keyframe(link->before).T_camera_world.t, T_before.t);
  // A tracker that was where the new end was is taken along.
  EXPECT_EQ(map_.corrections(), 1);
  const Pose followed = map_.correction().moved(T_now_old);
  EXPECT_LT((followed.inverse().t - map_.keyframe(link->now).T_camera_world.inverse().t).norm(),
            1e-9);
  // Every point still lies where the keyframes see it, to what drift there was between them.
  double worst = 0;
  for (PointId p = 0; p < map_.pointEnd(); ++p) {
    if (!map_.point(p).alive) continue;
    const Observation& o = map_.observations(p).front();
    const Keyframe& k = map_.keyframe(o.keyframe);
    const Keypoint& kp = k.features.keypoints[o.feature];
    const Eigen::Vector2d px = testCamera().project(k.T_camera_world * map_.point(p).position);
    worst = std::max(worst, (px - Eigen::Vector2d(kp.ux, kp.uy)).norm());
  }
  EXPECT_LT(worst, 15);
}

TEST_F(DriftedRing, IsAccurateAfterTheAdjustmentOfTheWholeMap) {
  const auto link = recognizer_.recognize(keyframes_.back());
  ASSERT_TRUE(link);
  ASSERT_TRUE(close(*link));
  BundleAdjuster adjuster(32, 3000, 36000);
  GlobalBundle bundle(settings_, map_, adjuster);
  bundle.adjust(1, 20, nullptr);
  EXPECT_LT(largestError(), 0.02);
  EXPECT_EQ(map_.corrections(), 2);
}

TEST_F(DriftedRing, AnAdjustmentThatIsStoppedAtOnceLeavesTheMapAlone) {
  const Pose before = map_.keyframe(keyframes_[7]).T_camera_world;
  const int points = map_.pointCount();
  BundleAdjuster adjuster(32, 3000, 36000);
  GlobalBundle bundle(settings_, map_, adjuster);
  const std::atomic<bool> stop = true;
  EXPECT_EQ(bundle.adjust(1, 20, &stop).end, BaSummary::End::Stopped);
  EXPECT_EQ(map_.keyframe(keyframes_[7]).T_camera_world.t, before.t);
  EXPECT_EQ(map_.pointCount(), points);
}

TEST_F(DriftedRing, IsAdjustedWithFewPointsWhereThereIsRoomForNoMore) {
  const auto link = recognizer_.recognize(keyframes_.back());
  ASSERT_TRUE(link);
  ASSERT_TRUE(close(*link));
  BundleAdjuster adjuster(32, 500, 3000);
  GlobalBundle bundle(settings_, map_, adjuster);
  bundle.adjust(1, 20, nullptr);
  EXPECT_LT(largestError(), 0.05);
  // Points that took no part have come along with their keyframes.
  double sum = 0;
  int n = 0;
  for (PointId p = 0; p < map_.pointEnd(); ++p) {
    if (!map_.point(p).alive) continue;
    const Observation& o = map_.observations(p).front();
    const Keyframe& k = map_.keyframe(o.keyframe);
    const Keypoint& kp = k.features.keypoints[o.feature];
    sum += (testCamera().project(k.T_camera_world * map_.point(p).position) -
            Eigen::Vector2d(kp.ux, kp.uy))
               .norm();
    ++n;
  }
  EXPECT_LT(sum / n, 6);
}

class RingWhoseScaleSlipped : public DriftedRing {
 protected:
  RingWhoseScaleSlipped() : DriftedRing(2.5) {}
};

/// Two views of the same points may differ in scale where there was little parallax.
TEST_F(RingWhoseScaleSlipped, IsClosed) {
  const double drifted = largestError();
  const auto link = recognizer_.recognize(keyframes_.back());
  ASSERT_TRUE(link);
  ASSERT_TRUE(close(*link));
  BundleAdjuster adjuster(32, 3000, 36000);
  GlobalBundle(settings_, map_, adjuster).adjust(1, 20, nullptr);
  EXPECT_LT(largestError(), 0.2 * drifted);
}

TEST_F(DriftedRing, IsNotBentIntoALoopThatIsNone) {
  auto link = recognizer_.recognize(keyframes_.back());
  ASSERT_TRUE(link);
  link->T_before_now =
      expSim3((Vector7d() << 0, 1.5, 0, 3, 0, 0, 0).finished()) * link->T_before_now;
  const Pose before = map_.keyframe(keyframes_[7]).T_camera_world;
  EXPECT_FALSE(close(*link));
  EXPECT_EQ(map_.keyframe(keyframes_[7]).T_camera_world.t, before.t);
  EXPECT_EQ(map_.corrections(), 0);
}

TEST_F(DriftedRing, IsClosedWithoutAllocating) {
  const auto link = recognizer_.recognize(keyframes_.back());
  ASSERT_TRUE(link);
  BundleAdjuster adjuster(32, 3000, 36000);
  GlobalBundle bundle(settings_, map_, adjuster);
  const std::vector<KeyframeId> around(keyframes_.end() - 4, keyframes_.end() - 1);
  takeAllocationCount();
  const AllocationScope counted;
  EXPECT_TRUE(closer_.close(*link, recognizer_.pairs(), recognizer_.window(), around));
  bundle.adjust(1, 5, nullptr);
  EXPECT_EQ(takeAllocationCount(), 0);
}

}  // namespace
}  // namespace depthscope::slam
