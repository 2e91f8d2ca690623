#include "platform/daemon/pose_predictor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;
using Time = PosePredictor::Time;

/// A camera that turns and moves steadily.
Pose poseAt(double seconds) {
  const double angle = 0.4 * seconds;
  Pose pose;
  pose.R = Eigen::AngleAxisd(angle, Eigen::Vector3d(0.2, 1, 0.1).normalized()).toRotationMatrix();
  pose.t = Eigen::Vector3d(30 * seconds, -10 * seconds, 5 * seconds);
  return pose;
}
Time time(double seconds) {
  return Time(std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds)));
}
double pixelError(const Pose& a, const Pose& b) {
  const Eigen::Vector3d point = b.inverse() * Eigen::Vector3d(10, 5, 80);
  const Eigen::Vector3d p = a * point, q = b * point;
  return 700 * (p.head<2>() / p.z() - q.head<2>() / q.z()).norm();
}

TEST(PosePredictor, CarriesASteadyMotionOn) {
  PosePredictor predictor;
  for (int i = 0; i <= 30; ++i) predictor.add(poseAt(i / 30.0), 0, time(i / 30.0));
  for (double later : {1 / 60.0, 1 / 30.0, 2 / 30.0}) {
    const double as_it_is = pixelError(poseAt(1), poseAt(1 + later));
    EXPECT_GT(as_it_is, 2);
    EXPECT_LT(pixelError(predictor.at(time(1 + later)), poseAt(1 + later)), 0.1 * as_it_is);
  }
}

TEST(PosePredictor, AStillCameraStaysStill) {
  PosePredictor predictor;
  for (int i = 0; i < 3; ++i) predictor.add(poseAt(2), 0, time(i / 30.0));
  EXPECT_LT(pixelError(predictor.at(time(0.1)), poseAt(2)), 1e-9);
}

TEST(PosePredictor, KeepsThePoseWhereThereIsNoVelocityToTell) {
  PosePredictor predictor;
  predictor.add(poseAt(0), 0, time(0));
  EXPECT_EQ(pixelError(predictor.at(time(0.03)), poseAt(0)), 0);
  predictor.add(poseAt(1), 0, time(1));
  EXPECT_EQ(pixelError(predictor.at(time(1.03)), poseAt(1)), 0) << "too long ago";
  predictor.add(poseAt(1.03), 1, time(1.03));
  EXPECT_EQ(pixelError(predictor.at(time(1.06)), poseAt(1.03)), 0) << "another map";
}

TEST(PosePredictor, DoesNotRunAwayWhenPosesStop) {
  PosePredictor predictor;
  predictor.add(poseAt(0), 0, time(0));
  predictor.add(poseAt(0.03), 0, time(0.03));
  const Pose far = predictor.at(time(10));
  EXPECT_LT(pixelError(far, poseAt(0.12)), 1);
}

TEST(PosePredictor, OldPosesAreLeftOutAndCorrectedOnesTaken) {
  PosePredictor predictor;
  predictor.add(poseAt(0), 0, time(0));
  predictor.add(poseAt(0.03), 0, time(0.03));
  predictor.add(poseAt(0.5), 0, time(0.01));
  EXPECT_LT(pixelError(predictor.at(time(0.06)), poseAt(0.06)), 0.2);
  predictor.add(poseAt(0.04), 0, time(0.03));
  EXPECT_EQ(pixelError(predictor.at(time(0.03)), poseAt(0.04)), 0);
}

}  // namespace
}  // namespace depthscope::platform
