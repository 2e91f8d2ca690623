// What becomes of pictures whose rows are exposed one after the other.
#include <gtest/gtest.h>

#include "tests/slam/plane_world.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// A hand that is not quite steady, at a time in frames.
Pose shakenPose(double frame) {
  const double s = 0.006 * frame;
  return cameraAt(
      {s + 0.03 * std::sin(0.25 * frame), 0.04 * std::sin(0.19 * frame), 0.1 * std::sin(3 * s)},
      {0.02 * std::cos(0.23 * frame), 0.015 * std::sin(0.3 * frame), 0.1 * s});
}

/// What a camera that takes `readout` of the time between frames to read a picture makes of it.
std::vector<PoseEstimate> runRolled(SlamSystem& slam, double readout, int frames) {
  const PlaneWorld world;
  std::vector<PoseEstimate> estimates;
  for (int i = 0; i < frames; ++i) {
    const cv::Mat image =
        world.rolledView([&](double row) { return shakenPose(i + readout * row); });
    estimates.push_back(slam.track(viewOf(image), i, i / 30.0));
  }
  return estimates;
}

TEST(RolledPictures, FindsOutThatRowsAreExposedOneAfterTheOther) {
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  runRolled(slam, 0.8, 90);
  EXPECT_EQ(slam.statistics().lost_events, 0);
  EXPECT_NEAR(slam.statistics().readout_s, 0.8 / 30, 0.08 / 30);
  // What it took the camera for at first has been put right.
  std::vector<PoseEstimate> corrected;
  for (const StampedPose& p : slam.correctedTrajectory()) {
    corrected.emplace_back().frame = p.frame;
    corrected.back().state = TrackingState::Tracking;
    corrected.back().T_camera_world = p.T_world_camera.inverse();
  }
  EXPECT_LT(pathError(corrected, shakenPose), 0.03)
      << "0.043 with the rows taken as exposed at once";
}

TEST(RolledPictures, TakesACameraThatExposesAllRowsAtOnceForWhatItIs) {
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  const auto estimates = runRolled(slam, 0, 90);
  EXPECT_EQ(slam.statistics().readout_s, 0);
  EXPECT_LT(pathError(estimates, shakenPose), 0.01);
}

}  // namespace
}  // namespace depthscope::slam
