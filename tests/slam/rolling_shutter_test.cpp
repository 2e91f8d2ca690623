#include "slam/rolling_shutter.hpp"

#include <gtest/gtest.h>

#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

constexpr double kInterval_s = 1.0 / 30;

/// A shutter that has seen frames and was told its readout.
class RollingShutterTest : public ::testing::Test {
 protected:
  RollingShutterTest() { shutter_.noteInterval(kInterval_s); }

  RollingShutter shutter_{testCameraModel()};
  const Twist twist_{{0.2, -0.3, 0.5}, {0.4, 0.1, -0.2}};
};

/// Where a camera sees the still point that is at `p` at the middle row's time: in the row that is
/// exposed just when the point is there.
Keypoint seenBy(const RollingShutter& shutter, const Twist& twist, const Eigen::Vector3d& p) {
  const CameraModel c = testCameraModel();
  const Intrinsics camera{c.fx, c.fy, c.cx, c.cy};
  Keypoint k;
  Eigen::Vector2d px = camera.project(p);
  for (int i = 0; i < 20; ++i) {
    const double t = shutter.readout() * ((px.y() + 0.5) / c.height - 0.5);
    px = camera.project(expSO3(twist.w * t) * p + twist.v * t);
  }
  k.x = k.ux = static_cast<float>(px.x());
  k.y = k.uy = static_cast<float>(px.y());
  return k;
}

TEST_F(RollingShutterTest, TwistIsTheMotionFromOnePoseToTheNext) {
  const Pose before = cameraAt({0.1, 0.2, 0.3}, {0.1, -0.2, 0.3});
  const Pose after = before.retract({0.001, 0.002, -0.003}, {0.004, -0.005, 0.006});
  const Twist twist = twistBetween(before, after, 0.01);
  EXPECT_LT((twist.w - Eigen::Vector3d(0.1, 0.2, -0.3)).norm(), 1e-9);
  EXPECT_LT((twist.v - Eigen::Vector3d(0.4, -0.5, 0.6)).norm(), 1e-9);
}

TEST_F(RollingShutterTest, WithoutAReadoutWhatIsSeenIsWhereItIs) {
  Keypoint k;
  k.ux = 20.5F;
  k.uy = k.y = 30.25F;
  EXPECT_EQ(shutter_.atMiddleRow(k, twist_, {0.1, 0.2, 2}), Eigen::Vector2d(20.5, 30.25));
}

TEST_F(RollingShutterTest, MovesWhatOtherRowsSawToTheMiddleRowsTime) {
  shutter_.correct(0.025, 0.001);
  ASSERT_DOUBLE_EQ(shutter_.readout(), 0.025);
  const CameraModel c = testCameraModel();
  const Intrinsics camera{c.fx, c.fy, c.cx, c.cy};
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0.5, 0.7, 2), {-0.6, -0.8, 2.5}, {0.1, 0, 3}, {-0.9, 0.9, 3}}) {
    const Keypoint seen = seenBy(shutter_, twist_, p);
    const double off = (camera.project(p) - Eigen::Vector2d(seen.ux, seen.uy)).norm();
    EXPECT_LT((shutter_.atMiddleRow(seen, twist_, p) - camera.project(p)).norm(), 0.03 + 0.03 * off)
        << "to first order; it is off by " << off << " px";
    EXPECT_LT((shutter_.atItsRow(p, twist_) - Eigen::Vector2d(seen.ux, seen.uy)).norm(),
              0.03 + 0.03 * off);
  }
}

TEST_F(RollingShutterTest, LeavesWhatIsNotBeforeTheCameraWhereItIs) {
  shutter_.correct(0.025, 0.001);
  Keypoint k;
  for (const double z : {0.0, -1.0})
    EXPECT_EQ(shutter_.atMiddleRow(k, twist_, {0.1, 0.2, z}), Eigen::Vector2d(0, 0));
}

TEST_F(RollingShutterTest, BelievesInAReadoutOnlyBeyondDoubt) {
  shutter_.correct(0.02, 0.004);
  EXPECT_EQ(shutter_.readout(), 0) << "five standard deviations";
  shutter_.correct(0.007, 0.0005);
  EXPECT_EQ(shutter_.readout(), 0) << "no camera reads out in a fifth of the time between frames";
  shutter_.correct(-0.02, 0.001);
  EXPECT_EQ(shutter_.readout(), 0) << "rows are exposed from the top";
  shutter_.correct(0.02, 0.001);
  EXPECT_DOUBLE_EQ(shutter_.readout(), 0.02);
}

TEST_F(RollingShutterTest, RefinesAReadoutAndGivesUpOneThatGoesAway) {
  shutter_.correct(0.02, 0.001);
  shutter_.correct(0.003, 0.01);
  EXPECT_DOUBLE_EQ(shutter_.readout(), 0.023);
  shutter_.correct(0.1, 0.001);
  EXPECT_DOUBLE_EQ(shutter_.readout(), kInterval_s) << "the next frame begins then";
  shutter_.correct(-0.03, 0.001);
  EXPECT_EQ(shutter_.readout(), 0);
}

TEST_F(RollingShutterTest, JudgesByTheShortestIntervalBetweenFrames) {
  RollingShutter shutter(testCameraModel());
  shutter.correct(0.02, 0.001);
  EXPECT_EQ(shutter.readout(), 0) << "no two frames were seen yet";
  shutter.noteInterval(0.1);
  shutter.noteInterval(0.0001);  // a fault of the time stamps
  shutter.correct(0.02, 0.001);
  EXPECT_EQ(shutter.readout(), 0);
  shutter.noteInterval(0.04);
  shutter.correct(0.02, 0.001);
  EXPECT_DOUBLE_EQ(shutter.readout(), 0.02);
}

}  // namespace
}  // namespace depthscope::slam
