#include "slam/place_recognizer.hpp"

#include <gtest/gtest.h>

#include "slam/map_merger.hpp"
#include "slam/trajectory.hpp"
#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_map.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

SlamSettings roomySettings() {
  SlamSettings s = smallSettings();
  s.capacity.keyframes = 24;
  s.capacity.map_points = 4000;
  return s;
}

/// One world mapped twice: first as it is, then, in a world frame and unit of its own, by a camera
/// that comes by again.
class TwoMapsOfOnePlace : public ::testing::Test {
 protected:
  TwoMapsOfOnePlace() { mapAgain(world_, sidewaysPoses(6, 0.15)); }

  /// Adds a second map to the first; points in it are distinct from those of the first. Of what its
  /// pictures show it has points for one in `every`.
  void mapAgain(const World& world, const std::vector<Pose>& true_poses, std::size_t every = 1) {
    map_.start();
    std::vector<std::vector<std::pair<KeyframeId, int>>> seen(world.points.size());
    for (std::size_t i = 0; i < true_poses.size(); ++i) {
      std::vector<int> ids;
      const FeatureSet f = world.view(true_poses[i], ids, 0.3);
      const KeyframeId k = map_.addKeyframe(f, T_new_old_.moved(true_poses[i]),
                                            100 + static_cast<std::int64_t>(i), 10.0);
      second_.push_back(k);
      for (std::size_t n = 0; n < ids.size(); ++n) seen[ids[n]].push_back({k, static_cast<int>(n)});
    }
    for (std::size_t i = 0; i < seen.size(); i += every) {
      if (seen[i].size() < 2) continue;
      const PointId p = map_.addPoint(T_new_old_ * world.points[i], 0);
      for (const auto& [k, feature] : seen[i]) map_.observe(p, k, feature);
      map_.refreshPoint(p);
    }
    for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k)
      if (map_.keyframe(k).alive) database_.add(map_, k);
  }

  SlamSettings settings_ = roomySettings();
  World world_{300};
  Sim3 T_new_old_ = expSim3((Vector7d() << 0.2, -0.1, 0.3, 1, 2, -1, 0.5).finished());
  MappedWorld mapped_{settings_, world_, sidewaysPoses(6, 0.2)};
  Map& map_ = mapped_.map;
  KeyframeDatabase database_{settings_, Vocabulary::builtIn()};
  std::vector<KeyframeId> second_;
  PlaceRecognizer recognizer_{settings_, map_, database_};
};

TEST_F(TwoMapsOfOnePlace, IsRecognisedWithItsSimilarity) {
  const auto link = recognizer_.recognize(second_[3]);
  ASSERT_TRUE(link);
  EXPECT_EQ(link->now, second_[3]);
  EXPECT_EQ(map_.keyframe(link->before).map_id, 1u);
  EXPECT_GT(link->matches, 100);
  EXPECT_LT(logSim3(link->T_before_now * T_new_old_).norm(), 0.02);
  EXPECT_GT(recognizer_.pairs().size(), 100u);
  for (const PointPair& pair : recognizer_.pairs())
    EXPECT_LT(
        (map_.point(pair.now).position - T_new_old_ * map_.point(pair.before).position).norm(),
        1e-6);
}

TEST_F(TwoMapsOfOnePlace, IsRecognisedWhereTheSecondMapHasFewPointsYet) {
  map_.removeMap(2);
  second_.clear();
  mapAgain(world_, sidewaysPoses(6, 0.15), 16);
  takeAllocationCount();
  const AllocationScope counted;
  const auto link = recognizer_.recognize(second_[3]);
  EXPECT_EQ(takeAllocationCount(), 0);
  ASSERT_TRUE(link);
  EXPECT_EQ(map_.keyframe(link->before).map_id, 1u);
  EXPECT_GT(link->matches, 100);
  EXPECT_LT(recognizer_.pairs().size(), 20u);  // too few for a similarity by RANSAC
  EXPECT_LT(logSim3(link->T_before_now * T_new_old_).norm(), 0.02);
}

TEST_F(TwoMapsOfOnePlace, AllocatesNothing) {
  takeAllocationCount();
  const AllocationScope counted;
  EXPECT_TRUE(recognizer_.recognize(second_[3]));
  EXPECT_EQ(takeAllocationCount(), 0);
}

TEST_F(TwoMapsOfOnePlace, IsNotRecognisedWhereAnotherPlaceLooksLikeNothingKnown) {
  map_.removeMap(2);
  second_.clear();
  const World elsewhere(300, 77);
  mapAgain(elsewhere, sidewaysPoses(6, 0.15));
  for (const KeyframeId k : second_) EXPECT_FALSE(recognizer_.recognize(k));
}

TEST_F(TwoMapsOfOnePlace, IsNotRecognisedFromTheSamePatchesInAnotherOrder) {
  // The same descriptors, so that the bags of words are alike, at other places.
  map_.removeMap(2);
  second_.clear();
  World shuffled = world_;
  std::mt19937 rng(4);
  std::shuffle(shuffled.points.begin(), shuffled.points.end(), rng);
  mapAgain(shuffled, sidewaysPoses(6, 0.15));
  for (const KeyframeId k : second_) EXPECT_FALSE(recognizer_.recognize(k));
}

TEST_F(TwoMapsOfOnePlace, BecomesOneMapInTheWorldOfTheOlder) {
  Trajectory trajectory(10);
  const KeyframeId k = second_[2];
  const Pose T_camera_world = T_new_old_.moved(cameraAt({0.35, 0, 0}, {0, 0, 0}));
  AnchoredPose frame;
  frame.frame = 7;
  frame.anchor(map_, k, T_camera_world * map_.keyframe(k).T_camera_world.inverse());
  trajectory.add(frame);

  const auto link = recognizer_.recognize(second_[3]);
  ASSERT_TRUE(link);
  PointFuser fuser(settings_, map_);
  MapMerger merger(map_, fuser);
  const int points_before = map_.pointCount();
  merger.merge(*link, recognizer_.pairs(), recognizer_.window(), second_);

  EXPECT_EQ(map_.mapCount(), 1);
  EXPECT_EQ(map_.activeId(), 1u);
  EXPECT_LT(map_.pointCount(), points_before * 6 / 10);  // each was there twice
  const auto truth = sidewaysPoses(6, 0.15);
  for (std::size_t i = 0; i < second_.size(); ++i) {
    EXPECT_EQ(map_.keyframe(second_[i]).map_id, 1u);
    EXPECT_LT((map_.keyframe(second_[i]).T_camera_world.inverse().t - truth[i].inverse().t).norm(),
              0.02);
    int shared_with_first = 0;
    for (const PointId p : map_.keyframe(second_[i]).points)
      shared_with_first += p != kNone && map_.isObservedBy(p, mapped_.keyframes[2]);
    EXPECT_GT(shared_with_first, 100);
  }
  // The frame that hung on a keyframe of the second map came along, lengths and all.
  const auto poses = trajectory.corrected(map_, 1);
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_LT((poses[0].T_world_camera.t - Eigen::Vector3d(0.35, 0, 0)).norm(), 0.02);
  // And so can the tracker's pose.
  EXPECT_EQ(map_.corrections(), 1);
  EXPECT_LT(
      (map_.correction().moved(T_camera_world).inverse().t - Eigen::Vector3d(0.35, 0, 0)).norm(),
      0.02);
}

TEST_F(TwoMapsOfOnePlace, ATrackerInTheOlderMapIsLeftWhereItIs) {
  map_.activate(1);
  const auto link = recognizer_.recognize(mapped_.keyframes[3]);
  ASSERT_TRUE(link);
  PointFuser fuser(settings_, map_);
  MapMerger merger(map_, fuser);
  const Pose before = map_.keyframe(mapped_.keyframes[3]).T_camera_world;
  merger.merge(*link, recognizer_.pairs(), recognizer_.window(), {});
  EXPECT_EQ(map_.mapCount(), 1);
  EXPECT_EQ(map_.corrections(), 0);
  EXPECT_EQ(map_.keyframe(mapped_.keyframes[3]).T_camera_world.t, before.t);
  EXPECT_LT(map_.keyframe(second_[2]).T_camera_world.inverse().t.norm(), 0.5);
}

TEST_F(TwoMapsOfOnePlace, KeyframesThatShareWhatTheySeeAreNoLink) {
  map_.removeMap(2);
  for (const KeyframeId k : mapped_.keyframes) EXPECT_FALSE(recognizer_.recognize(k));
}

}  // namespace
}  // namespace depthscope::slam
