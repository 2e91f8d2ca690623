#include "slam/slam_system.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/plane_world.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// With normal noise of `sigma` grey levels.
cv::Mat noisy(const cv::Mat& image, double sigma, cv::RNG& random) {
  cv::Mat noise(image.size(), CV_16S), levels, result;
  random.fill(noise, cv::RNG::NORMAL, 0, sigma);
  image.convertTo(levels, CV_16S);
  cv::Mat(levels + noise).convertTo(result, CV_8U);
  return result;
}

TEST(SlamSystem, FollowsACameraOverATexturedPlane) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  const auto estimates = run(slam, world, 0, 60);
  EXPECT_EQ(slam.statistics().maps, 1);
  EXPECT_EQ(slam.statistics().lost_events, 0);
  EXPECT_EQ(estimates.back().state, TrackingState::Tracking);
  EXPECT_GT(estimates.back().confidence, 0.5f);
  EXPECT_LT(pathError(estimates), 0.01);  // of a path of about half a unit, a unit from the plane
  EXPECT_GT(slam.correctedTrajectory().size(), 45u);
}

TEST(SlamSystem, StartsAMapThroughNoiseInWhichDescriptorsAreLost) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  cv::RNG random(5);
  int first = -1;
  std::vector<PoseEstimate> estimates;
  for (int i = 0; i < 60; ++i) {
    cv::Mat dark;
    world.view(poseAt(i)).convertTo(dark, CV_8U, 0.4, 20);
    const cv::Mat image = noisy(dark, 6, random);
    estimates.push_back(slam.track(viewOf(image), i, i / 30.0));
    if (first < 0 && estimates.back().state == TrackingState::Tracking) first = i;
  }
  EXPECT_GE(first, 1);
  EXPECT_LE(first, 15);
  EXPECT_EQ(estimates.back().state, TrackingState::Tracking);
  EXPECT_LT(pathError(estimates), 0.03);
}

TEST(SlamSystem, StartsNoMapWhileTheCameraStandsStill) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  cv::RNG rng(1);
  const cv::Mat still = world.view(poseAt(0));
  for (int i = 0; i < 20; ++i) {
    const cv::Mat image = noisy(still, 3, rng);
    EXPECT_EQ(slam.track(viewOf(image), i, i / 30.0).state, TrackingState::Initializing);
  }
  EXPECT_EQ(slam.statistics().maps, 0);
}

TEST(SlamSystem, StartsNoMapFromACameraThatOnlyTurns) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  for (int i = 0; i < 20; ++i) {
    const cv::Mat image = world.view(cameraAt({0, 0, 0}, {0, 0.01 * i, 0.005 * i}));
    slam.track(viewOf(image), i, i / 30.0);
  }
  EXPECT_EQ(slam.statistics().maps, 0);
}

TEST(SlamSystem, IsLostInTheDarkAndFindsItsPlaceAgain) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  run(slam, world, 0, 50);
  ASSERT_GT(slam.statistics().keyframes, 5);
  const cv::Mat dark(480, 640, CV_8U, cv::Scalar(0));
  for (int i = 50; i < 60; ++i)
    EXPECT_EQ(slam.track(viewOf(dark), i, i / 30.0).state, TrackingState::Lost);
  const cv::Mat known = world.view(poseAt(30));
  const PoseEstimate e = slam.track(viewOf(known), 60, 2.0);
  EXPECT_EQ(e.state, TrackingState::Tracking);
  EXPECT_EQ(slam.statistics().relocalizations, 1);
  EXPECT_EQ(slam.statistics().maps, 1);
}

TEST(SlamSystem, GoesOnAfterAFewBlurredPictures) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  run(slam, world, 0, 50);
  ASSERT_GT(slam.statistics().keyframes, 5);  // a younger map would be given up
  for (int i = 50; i < 54; ++i) {
    cv::Mat blurred;
    cv::blur(world.view(poseAt(i)), blurred, {61, 61});
    EXPECT_EQ(slam.track(viewOf(blurred), i, i / 30.0).state, TrackingState::Lost);
  }
  const auto after = run(slam, world, 54, 70);
  EXPECT_EQ(after.front().state, TrackingState::Tracking);
  EXPECT_EQ(after.back().state, TrackingState::Tracking);
  EXPECT_EQ(slam.statistics().lost_events, 1);
  EXPECT_EQ(slam.statistics().relocalizations, 1);
  EXPECT_EQ(slam.statistics().maps, 1);
}

TEST(SlamSystem, DoesNotMistakeAnotherPlaceForTheOneItKnows) {
  const PlaneWorld world, elsewhere(9);
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  run(slam, world, 0, 50);
  const std::uint32_t known = slam.track(viewOf(world.view(poseAt(50))), 50, 50 / 30.0).map_id;
  for (int i = 51; i < 100; ++i) {
    const cv::Mat image = elsewhere.view(poseAt(i));
    const PoseEstimate e = slam.track(viewOf(image), i, i / 30.0);
    EXPECT_FALSE(e.state == TrackingState::Tracking && e.map_id == known) << i;
  }
  EXPECT_EQ(slam.statistics().relocalizations, 0);
}

TEST(SlamSystem, TheSamePicturesGiveTheSameBits) {
  const PlaneWorld world;
  SlamSystem a(testCameraModel(), testSettings(), MappingMode::Lockstep);
  SlamSystem b(testCameraModel(), testSettings(), MappingMode::Lockstep);
  run(a, world, 0, 40);
  run(b, world, 0, 40);
  const auto ta = a.correctedTrajectory(), tb = b.correctedTrajectory();
  ASSERT_EQ(ta.size(), tb.size());
  for (std::size_t i = 0; i < ta.size(); ++i)
    EXPECT_EQ(std::memcmp(&ta[i].T_world_camera, &tb[i].T_world_camera, sizeof(Pose)), 0);
}

TEST(SlamSystem, StaysWithinItsCapacityAndKeepsTracking) {
  const PlaneWorld world;
  SlamSettings settings = testSettings();
  settings.capacity.keyframes = 8;
  SlamSystem slam(testCameraModel(), settings, MappingMode::Lockstep);
  const auto estimates = run(slam, world, 0, 80);
  EXPECT_LE(slam.statistics().keyframes, 8);
  EXPECT_EQ(estimates.back().state, TrackingState::Tracking);
}

TEST(SlamSystem, TracksInASmallMapThatIsFullAllTheTime) {
  const PlaneWorld world;
  SlamSettings settings = testSettings();
  settings.capacity.keyframes = 16;
  settings.capacity.map_points = 1000;
  settings.capacity.observations_per_point = 4;
  settings.capacity.local_points = 500;
  SlamSystem slam(testCameraModel(), settings, MappingMode::Lockstep);
  const std::size_t bytes = slam.memory().total();
  int tracked = 0;
  for (int i = 0; i < 240; ++i) {  // there, back, and there again
    const cv::Mat image = world.view(poseAt(i < 80 ? i : i < 160 ? 160 - i : i - 160));
    tracked += slam.track(viewOf(image), i, i / 30.0).state == TrackingState::Tracking;
    ASSERT_LE(slam.statistics().keyframes, 16);
    ASSERT_LE(slam.statistics().map_points, 1000);
  }
  EXPECT_GT(tracked, 220);
  EXPECT_EQ(slam.statistics().maps, 1);
  EXPECT_EQ(slam.memory().total(), bytes);
}

TEST(SlamSystem, IsFoundAgainWhereverInItsMapTheScopeIsPutBack) {
  const PlaneWorld world;
  const cv::Mat outside(480, 640, CV_8U, cv::Scalar(0));
  for (const int place : {10, 70}) {
    SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
    const std::uint32_t map_id = run(slam, world, 0, 80).back().map_id;
    const auto known = slam.correctedTrajectory();
    const auto there = std::find_if(known.begin(), known.end(),
                                    [&](const StampedPose& p) { return p.frame == place; });
    ASSERT_NE(there, known.end());
    for (int i = 80; i < 125; ++i) slam.track(viewOf(outside), i, i / 30.0);
    const cv::Mat image = world.view(poseAt(place));
    PoseEstimate found;
    int tries = 0;
    while (found.state != TrackingState::Tracking && tries < 10) {
      found = slam.track(viewOf(image), 125 + tries, (125 + tries) / 30.0);
      ++tries;
    }
    ASSERT_EQ(found.state, TrackingState::Tracking) << place;
    EXPECT_EQ(found.map_id, map_id);
    // To a hundredth of the distance to the plane.
    EXPECT_LT((found.T_camera_world.inverse().t - there->T_world_camera.t).norm(), 0.01) << place;
  }
}

TEST(SlamSystem, AllocatesNothingOnceItIsBuilt) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  takeAllocationCount();
  run(slam, world, 0, 60);
  run(slam, PlaneWorld(9), 60, 110);  // lost, sought for in vain, a second map
  run(slam, world, 50, 55);           // relocalized in the first
  EXPECT_GT(slam.statistics().lost_events, 0);
  EXPECT_GT(slam.statistics().relocalizations, 0);
  EXPECT_EQ(takeAllocationCount(), 0);
}

TEST(SlamSystem, MapsInAThreadOfItsOwn) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Threaded);
  const auto estimates = run(slam, world, 0, 40);
  EXPECT_EQ(estimates.back().state, TrackingState::Tracking);
  SparseCloud cloud;
  slam.copyCloud(cloud);
  EXPECT_GT(cloud.points.size(), 100u);
}

TEST(SlamSystem, TellsWhichFramesAreKeyframesAndWhatTheySee) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  std::vector<std::int64_t> made;
  for (int i = 0; i < 60; ++i) {
    run(slam, world, i, i + 1);
    if (slam.wantsPicture()) made.push_back(i);
  }
  SparseCloud cloud;
  slam.copyCloud(cloud);
  ASSERT_EQ(cloud.view_frames.size(), cloud.views_T_camera_world.size());
  // All but the first of the two that began the map were announced; culled ones are gone.
  int announced = 0;
  for (const std::int64_t frame : cloud.view_frames)
    announced += std::find(made.begin(), made.end(), frame) != made.end();
  EXPECT_GE(announced, static_cast<int>(cloud.view_frames.size()) - 1);
  EXPECT_GE(announced, 1);
  EXPECT_LT(made.size(), 60u);

  std::vector<int> sightings(cloud.points.size());
  for (const Sighting& s : cloud.sightings) {
    ASSERT_LT(s.view, cloud.keyframes);
    ++sightings.at(s.point);
    const Eigen::Vector3d seen =
        cloud.views_T_camera_world[s.view] * cloud.points[s.point].position.cast<double>();
    EXPECT_GT(seen.z(), 0);
  }
  for (std::size_t i = 0; i < sightings.size(); ++i)
    EXPECT_EQ(sightings[i], cloud.points[i].observations);
}

TEST(SlamSystem, LooksForMoreFeaturesWhereNoMapBeginsAndWhereFewAreFound) {
  constexpr int kFeatures = 90;
  const PlaneWorld world;
  SlamSettings settings = testSettings();
  settings.extractor.features = kFeatures;
  int found[2] = {};
  for (const bool weak : {false, true}) {
    settings.tracker.weak_below = weak ? 600 : 0;
    SlamSystem slam(testCameraModel(), settings, MappingMode::Lockstep);
    int frame = 0;
    for (; frame < 30 && slam.statistics().maps == 0; ++frame) run(slam, world, frame, frame + 1);
    EXPECT_GT(slam.statistics().map_points, kFeatures);
    // Corners of the clear picture are mostly not the strongest of a noisy one.
    cv::RNG random(1);
    for (const int end = frame + 10; frame < end; ++frame) {
      const cv::Mat image = noisy(world.view(poseAt(frame)), 8, random);
      const PoseEstimate e = slam.track(viewOf(image), frame, frame / 30.0);
      EXPECT_EQ(e.state, TrackingState::Tracking);
      found[weak] += e.inliers;
    }
  }
  EXPECT_GT(found[true], 1.1 * found[false]);
}

TEST(SlamSystem, ResetForgetsTheMap) {
  const PlaneWorld world;
  SlamSystem slam(testCameraModel(), testSettings(), MappingMode::Lockstep);
  run(slam, world, 0, 20);
  slam.reset();
  EXPECT_EQ(slam.statistics().keyframes, 0);
  EXPECT_TRUE(slam.correctedTrajectory().empty());
  const auto again = run(slam, world, 20, 40);
  EXPECT_EQ(again.back().state, TrackingState::Tracking);
  EXPECT_EQ(slam.statistics().maps, 1);
}

}  // namespace
}  // namespace depthscope::slam
