#include "slam/view_keeper.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam::testing {
namespace {

class ViewKeeperTest : public ::testing::Test {
 protected:
  /// A frame `x` to the side of the first keyframe.
  AnchoredPose frameAt(double x, std::int64_t frame) {
    AnchoredPose pose;
    pose.frame = frame;
    pose.anchor(mapped_.map, mapped_.keyframes[0],
                cameraAt({x, 0, 0}, {0, 0, 0}) *
                    mapped_.map.keyframe(mapped_.keyframes[0]).T_camera_world.inverse());
    return pose;
  }
  bool offer(ViewKeeper& keeper, double x, std::int64_t frame, bool keyframe = false) {
    return keeper.offer(mapped_.map, frameAt(x, frame), kDepth, keyframe);
  }
  static std::vector<std::int64_t> framesOf(const ViewKeeper& keeper) {
    std::vector<std::int64_t> frames;
    for (const AnchoredPose& pose : keeper.poses()) frames.push_back(pose.frame);
    std::sort(frames.begin(), frames.end());
    return frames;
  }

  static constexpr double kDepth = 2;
  const World world_{100};
  MappedWorld mapped_{smallSettings(), world_, sidewaysPoses(2, 0.1)};
};

TEST_F(ViewKeeperTest, KeepsWhatIsSeenFromANewPlace) {
  ViewKeeper keeper(10, 0.1);
  EXPECT_TRUE(offer(keeper, 0, 1));
  EXPECT_FALSE(offer(keeper, 0.19, 2));  // less than a tenth of the depth away
  EXPECT_TRUE(offer(keeper, 0.21, 3));
  EXPECT_FALSE(offer(keeper, 0.02, 4));  // back where it was
  EXPECT_EQ(framesOf(keeper), (std::vector<std::int64_t>{1, 3}));
}

TEST_F(ViewKeeperTest, KeepsEveryKeyframe) {
  ViewKeeper keeper(10, 0.1);
  EXPECT_TRUE(offer(keeper, 0, 1));
  EXPECT_TRUE(offer(keeper, 0.01, 2, true));
}

TEST_F(ViewKeeperTest, LooksOnlyAtViewsOfItsMap) {
  ViewKeeper keeper(10, 0.1);
  ASSERT_TRUE(offer(keeper, 0, 1));
  mapped_.map.start();
  const FeatureSet none(10, testCameraModel());
  const KeyframeId other = mapped_.map.addKeyframe(none, cameraAt({0, 0, 0}, {0, 0, 0}), 5, 5);
  AnchoredPose frame;
  frame.frame = 5;
  frame.anchor(mapped_.map, other, Pose{});
  EXPECT_TRUE(keeper.offer(mapped_.map, frame, kDepth, false));
}

TEST_F(ViewKeeperTest, WhenFullTheViewWithTheNearestNeighbourGoes) {
  ViewKeeper keeper(3, 0.1);
  ASSERT_TRUE(offer(keeper, 0, 1));
  ASSERT_TRUE(offer(keeper, 1, 2));
  ASSERT_TRUE(offer(keeper, 1.3, 3));
  ASSERT_TRUE(offer(keeper, 3, 4));
  const auto frames = framesOf(keeper);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(std::count(frames.begin(), frames.end(), 1));
  EXPECT_TRUE(std::count(frames.begin(), frames.end(), 4));
}

TEST_F(ViewKeeperTest, AViewThatBecameAKeyframeMovesWithIt) {
  ViewKeeper keeper(3, 0.1);
  ASSERT_TRUE(offer(keeper, 0.1, 1, true));
  keeper.becameKeyframe(mapped_.map, 1, mapped_.keyframes[1]);
  const Pose& keyframe = mapped_.map.keyframe(mapped_.keyframes[1]).T_camera_world;
  EXPECT_LT((keeper.poses()[0].T_camera_world(mapped_.map).t - keyframe.t).norm(), 1e-6);
}

TEST_F(ViewKeeperTest, WithoutRoomOrDepthNothingIsKept) {
  ViewKeeper none(0, 0.1), keeper(3, 0.1);
  EXPECT_FALSE(offer(none, 0, 1));
  EXPECT_FALSE(keeper.offer(mapped_.map, frameAt(0, 1), 0, true));
}

}  // namespace
}  // namespace depthscope::slam::testing
