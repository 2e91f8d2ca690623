#include "platform/display/kms/mode_choice.hpp"

#include <gtest/gtest.h>

#include "tests/fake_kernel/fake_kms_card.hpp"

namespace depthscope::platform::kms {
namespace {

using fake::makeMode;

drm_mode_modeinfo with(drm_mode_modeinfo mode, std::uint32_t flags) {
  mode.flags |= flags;
  return mode;
}

/// The mode that is chosen, as "WxH@R", with the rate rounded.
std::string chosen(const std::vector<drm_mode_modeinfo>& modes, const PictureRate& picture,
                   const std::string& request = "auto") {
  const auto index = chooseMode(modes, picture, parseModeRequest(request));
  if (!index) return "none";
  const drm_mode_modeinfo& m = modes[*index];
  return std::to_string(m.hdisplay) + "x" + std::to_string(m.vdisplay) + "@" +
         std::to_string(static_cast<int>(refreshRate(m) + 0.5));
}

const std::vector<drm_mode_modeinfo> theatre{
    makeMode(3840, 2160, 30, true), makeMode(1920, 1080, 60), makeMode(1920, 1080, 50),
    makeMode(1920, 1080, 25),       makeMode(1280, 1024, 75), makeMode(1280, 720, 60),
    makeMode(1280, 720, 50),        makeMode(720, 576, 50),   makeMode(640, 480, 59.94)};

TEST(ModeChoice, SizeAndRateOfThePictureComeFirst) {
  EXPECT_EQ(chosen(theatre, {1920, 1080, 50}), "1920x1080@50");
  EXPECT_EQ(chosen(theatre, {1920, 1080, 60}), "1920x1080@60");
  EXPECT_EQ(chosen(theatre, {1920, 1080, 25}), "1920x1080@25");
  EXPECT_EQ(chosen(theatre, {640, 480, 60}), "640x480@60");  // 59.94 is near enough
}

TEST(ModeChoice, ThenTheSmallestMultipleOfTheRate) {
  EXPECT_EQ(chosen(theatre, {1920, 1080, 30}), "1920x1080@60");
  EXPECT_EQ(chosen(theatre, {1280, 720, 25}), "1280x720@50");
}

TEST(ModeChoice, ThenTheSizeAtTheHighestRate) {
  EXPECT_EQ(chosen(theatre, {1920, 1080, 24}), "1920x1080@60");
  EXPECT_EQ(chosen(theatre, {1280, 720, 0}), "1280x720@60");
}

TEST(ModeChoice, ThenThePreferredModeThatHasRoomThenTheSmallestThatHas) {
  EXPECT_EQ(chosen(theatre, {1024, 768, 30}), "3840x2160@30");
  std::vector<drm_mode_modeinfo> modes = theatre;
  modes[0].type = DRM_MODE_TYPE_DRIVER;
  EXPECT_EQ(chosen(modes, {1024, 768, 30}), "1280x1024@75");
  modes[7].type |= DRM_MODE_TYPE_PREFERRED;  // too small: of no use
  EXPECT_EQ(chosen(modes, {1024, 768, 30}), "1280x1024@75");
}

TEST(ModeChoice, AtLastTheLargestThereIs) {
  EXPECT_EQ(chosen(theatre, {4096, 2304, 30}), "3840x2160@30");
}

TEST(ModeChoice, LeavesInterlacedAndStereoModesOut) {
  const std::vector<drm_mode_modeinfo> modes{
      with(makeMode(1920, 1080, 60), DRM_MODE_FLAG_INTERLACE),
      with(makeMode(1920, 1080, 60), DRM_MODE_FLAG_3D_FRAME_PACKING), makeMode(1280, 720, 60)};
  EXPECT_EQ(chosen(modes, {1920, 1080, 60}), "1280x720@60");
  EXPECT_EQ(chosen({modes[0], modes[1]}, {1920, 1080, 60}), "none");
  EXPECT_EQ(chosen({}, {1920, 1080, 60}), "none");
}

TEST(ModeChoice, TheModeAskedForComesBeforeAll) {
  EXPECT_EQ(chosen(theatre, {1920, 1080, 50}, "1280x720@60"), "1280x720@60");
  EXPECT_EQ(chosen(theatre, {1920, 1080, 50}, "1280x720"), "1280x720@50");
  EXPECT_EQ(chosen(theatre, {1920, 1080, 24}, "1280x720"), "1280x720@60");
}

TEST(ModeChoice, AModeThatTheMonitorLacksIsNoReasonToShowNothing) {
  EXPECT_EQ(chosen(theatre, {1920, 1080, 50}, "800x600"), "1920x1080@50");
  EXPECT_EQ(chosen(theatre, {1920, 1080, 50}, "1280x720@100"), "1920x1080@50");
}

}  // namespace
}  // namespace depthscope::platform::kms
