// The test plays the AR process; pictures go through the video loop as they do in the daemon.
#include "platform/daemon/map_scale_keeper.hpp"

#include "expect_input_error.hpp"
#include "video_loop_fixture.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

class MapScaleKeeperTest : public VideoLoopFixture {
 protected:
  void SetUp() override {
    VideoLoopFixture::SetUp();
    link.setAlive(true);
  }
  /// A picture whose pose is known at once.
  void showTracked() {
    showPicture(false);
    sendPose(sequence - 1);
  }
  SurfaceMesh surfaceOf(std::uint32_t map_id) const {
    SurfaceMesh mesh;
    mesh.map_id = map_id;
    return mesh;
  }
  void sendPoseOf(std::uint32_t map_id) {
    PoseEstimate pose;
    pose.frame = sequence - 1;
    pose.state = TrackingState::Tracking;
    pose.map_id = map_id;
    memory.block().pose.write(encodePose(pose));
  }

  PoseWait poses{memory, system};
  MapScaleKeeper keeper{camera, memory, link, poses};
  // The fixture's surface is 15 + 15 wide, and as much nearer on the left.
  const std::string request = "12 60,60 100,60";
};

TEST_F(MapScaleKeeperTest, MeasuresAndKeepsTheScaleOfTheTrackedMap) {
  sendSurface();
  showTracked();
  const MapScale scale = keeper.measure(request);
  EXPECT_GT(scale.mm_per_unit, 0);
  ASSERT_TRUE(keeper.of(surfaceOf(0)));
  EXPECT_EQ(keeper.of(surfaceOf(0))->mm_per_unit, scale.mm_per_unit);
  ASSERT_TRUE(keeper.ofTrackedMap());
  showTracked();
  EXPECT_TRUE(keeper.ofTrackedMap());
}

TEST_F(MapScaleKeeperTest, AnotherMapHasNoScaleAndTheFirstOneKeepsIt) {
  sendSurface();
  showTracked();
  keeper.measure(request);
  EXPECT_FALSE(keeper.of(surfaceOf(1)));
  sendPoseOf(1);
  EXPECT_FALSE(keeper.ofTrackedMap());
  EXPECT_INPUT_ERROR(keeper.measure(request), HasSubstr("another map"));
  sendPoseOf(0);
  EXPECT_TRUE(keeper.ofTrackedMap());
}

TEST_F(MapScaleKeeperTest, IsForgottenOnResetAndWithTheArProcess) {
  sendSurface();
  showTracked();
  keeper.measure(request);
  keeper.forget();
  EXPECT_FALSE(keeper.of(surfaceOf(0)));
  keeper.measure(request);
  keeper.arStarted();
  EXPECT_FALSE(keeper.of(surfaceOf(0)));
  EXPECT_INPUT_ERROR(keeper.measure(request), HasSubstr("no surface yet"));
  sendSurface();
  EXPECT_NO_THROW(keeper.measure(request));
}

TEST_F(MapScaleKeeperTest, SaysWhyThereIsNoScale) {
  showPicture(false);
  EXPECT_INPUT_ERROR(keeper.measure(request), HasSubstr("not tracked"));
  showTracked();
  EXPECT_INPUT_ERROR(keeper.measure(request), HasSubstr("no surface yet"));
  sendSurface();
  EXPECT_NO_THROW(keeper.measure(request));
  EXPECT_INPUT_ERROR(keeper.measure("12 60,60 100,600"), HasSubstr("outside the picture"));
  EXPECT_INPUT_ERROR(keeper.measure("12 60,60"), HasSubstr("MM X1,Y1 X2,Y2"));
  EXPECT_TRUE(keeper.of(surfaceOf(0))) << "a request that fails changes nothing";
  system.advance(milliseconds(130));
  EXPECT_INPUT_ERROR(keeper.measure(request), HasSubstr("not tracked"));
  showTracked();
  EXPECT_NO_THROW(keeper.measure(request));
  link.setAlive(false);
  EXPECT_INPUT_ERROR(keeper.measure(request), HasSubstr("not tracked"));
}

TEST_F(MapScaleKeeperTest, ASnapshotIsMeasuredFromWhereItWasTaken) {
  sendSurface();
  EXPECT_INPUT_ERROR(keeper.measure("snapshot " + request), HasSubstr("no snapshot"));
  showTracked();
  EXPECT_TRUE(keeper.noteSnapshot(sequence - 1));
  const double there = keeper.measure("snapshot " + request).mm_per_unit;
  // The scope has gone on, to 70 mm instead of 50.
  showPicture(false);
  PoseEstimate pose;
  pose.frame = sequence - 1;
  pose.state = TrackingState::Tracking;
  pose.T_camera_world.t.z() = 20;
  memory.block().pose.write(encodePose(pose));
  EXPECT_LT(keeper.measure(request).mm_per_unit, 0.8 * there);
  EXPECT_EQ(keeper.measure("snapshot " + request).mm_per_unit, there);
  system.advance(std::chrono::seconds(100));
  EXPECT_EQ(keeper.measure("snapshot " + request).mm_per_unit, there);
}

TEST_F(MapScaleKeeperTest, ASnapshotWithoutAPoseOfItsOwnIsOfNoUse) {
  sendSurface();
  showTracked();
  keeper.noteSnapshot(sequence - 1);
  showTracked();
  EXPECT_FALSE(keeper.noteSnapshot(sequence - 2)) << "the newest pose is of a later picture";
  EXPECT_INPUT_ERROR(keeper.measure("snapshot " + request), HasSubstr("no snapshot"));
  keeper.noteSnapshot(-1);
  EXPECT_INPUT_ERROR(keeper.measure("snapshot " + request), HasSubstr("no snapshot"));
  keeper.noteSnapshot(sequence + 1);  // not looked at in time
  EXPECT_INPUT_ERROR(keeper.measure("snapshot " + request), HasSubstr("no snapshot"));
}

}  // namespace
}  // namespace depthscope::platform
