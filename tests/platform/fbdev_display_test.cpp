#include "platform/display/fbdev/fbdev_display.hpp"

#include <gtest/gtest.h>

#include "tests/fake_kernel/fake_framebuffer.hpp"

namespace depthscope::platform {
namespace {

using fake::FakeFramebuffer;
using std::chrono::milliseconds;

constexpr int width = 64, height = 48;
constexpr std::uint32_t console = 0x5a5a5a5a;

class FbdevDisplayTest : public ::testing::Test {
 protected:
  FbdevDisplayTest() { plug(width, height, 32, 2); }

  void plug(int w, int h, int bits, int screens) {
    display.reset();
    fb.reset();
    fb = std::make_unique<FakeFramebuffer>(kernel, "/dev/fb0", w, h, bits, screens);
  }
  void makeDisplay() { display = std::make_unique<fbdev::FbdevDisplay>(settings, kernel); }
  bool turn(std::uint32_t rgb, int w = width, int h = height) {
    const auto out = display->acquire(w, h);
    if (!out.empty()) {
      for (std::size_t i = 0; i < out.size(); i += 4) {
        out[i] = static_cast<std::uint8_t>(rgb >> 16);
        out[i + 1] = static_cast<std::uint8_t>(rgb >> 8);
        out[i + 2] = static_cast<std::uint8_t>(rgb);
        out[i + 3] = 255;
      }
      display->present(++index);
    }
    kernel.advance(milliseconds(33));
    return !out.empty();
  }

  fake::FakeKernel kernel;
  std::unique_ptr<FakeFramebuffer> fb;
  DisplaySettings settings;
  std::unique_ptr<fbdev::FbdevDisplay> display;
  std::int64_t index = 0;
};

TEST_F(FbdevDisplayTest, ShowsPicturesInTurnOnTwoPages) {
  makeDisplay();
  for (std::uint32_t i = 0; i < 6; ++i) {
    const unsigned before = fb->yOffset();
    EXPECT_TRUE(turn(0x102030 + i));
    EXPECT_NE(fb->yOffset(), before);
    EXPECT_EQ(fb->pixel(0, 0), 0xff102030 + i);
    EXPECT_EQ(fb->pixel(width - 1, height - 1), 0xff102030 + i);
  }
  EXPECT_EQ(display->state(), DisplayState::Ok);
  EXPECT_EQ(display->mode().width, width);
  EXPECT_GE(fb->unblanked, 1);
}

TEST_F(FbdevDisplayTest, PutsTheConsoleBackAtTheEnd) {
  for (const int screens : {1, 2}) {
    plug(width, height, 32, screens);
    makeDisplay();
    for (int i = 0; i < 3; ++i) turn(1);
    display.reset();
    EXPECT_EQ(fb->yOffset(), 0u);
    EXPECT_EQ(fb->pixel(0, 0), console);
    EXPECT_EQ(fb->pixel(width - 1, height - 1), console);
    EXPECT_EQ(kernel.openDescriptors(), 0u);
    EXPECT_EQ(kernel.mappings(), 0u);
  }
}

TEST_F(FbdevDisplayTest, DrawsInPlaceWhereThereIsRoomForOneScreenOrNoPanning) {
  plug(width, height, 32, 1);
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(0x112233);
  EXPECT_EQ(fb->pixel(3, 4), 0xff112233u);
  plug(width, height, 32, 2);
  fb->can_pan = false;
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(0x112233);
  EXPECT_EQ(fb->pixel(3, 4), 0xff112233u);
  EXPECT_EQ(display->state(), DisplayState::Ok);
}

TEST_F(FbdevDisplayTest, KnowsTheUsualDepths) {
  plug(width, height, 24, 2);
  makeDisplay();
  turn(0x112233);
  EXPECT_EQ(fb->pixel(5, 6), 0x112233u);
  plug(width, height, 16, 2);
  makeDisplay();
  turn(0xff8040);
  EXPECT_EQ(fb->pixel(5, 6), 0xfc08u);
  plug(width, height, 32, 2);
  std::swap(fb->var_.red, fb->var_.blue);
  makeDisplay();
  turn(0x112233);
  EXPECT_EQ(fb->pixel(5, 6), 0xff332211u);
}

TEST_F(FbdevDisplayTest, SaysSoWhenItCannotDrawThere) {
  fb->var_.bits_per_pixel = 8;
  makeDisplay();
  EXPECT_FALSE(turn(1));
  EXPECT_EQ(display->state(), DisplayState::Unsupported);
  plug(width, height, 32, 2);
  fb->denied = true;
  makeDisplay();
  EXPECT_FALSE(turn(1));
  EXPECT_EQ(display->state(), DisplayState::PermissionDenied);
  settings.device = "/dev/fb9";
  makeDisplay();
  EXPECT_FALSE(turn(1));
  EXPECT_EQ(display->state(), DisplayState::NoDevice);
}

TEST_F(FbdevDisplayTest, CentresThePictureOnBlack) {
  plug(100, 60, 32, 2);
  makeDisplay();
  turn(0xffffff);
  EXPECT_EQ(fb->pixel(17, 30), 0u);
  EXPECT_EQ(fb->pixel(18, 6), 0xffffffffu);
  EXPECT_EQ(fb->pixel(81, 53), 0xffffffffu);
  EXPECT_EQ(fb->pixel(82, 54), 0u);
  turn(0xffffff, 20, 20);
  EXPECT_EQ(fb->pixel(18, 6), 0u);
  EXPECT_EQ(fb->pixel(50, 30), 0xffffffffu);
}

TEST_F(FbdevDisplayTest, FollowsAModeThatAnotherProgramSets) {
  plug(width, height, 32, 8);
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  fb->setMode(100, 60, 32);
  for (int i = 0; i < 10; ++i) turn(2);
  EXPECT_EQ(display->mode().width, 100);
  EXPECT_EQ(fb->pixel(50, 30), 0xff000002u);
  EXPECT_EQ(fb->pixel(1, 1), 0u);
}

TEST_F(FbdevDisplayTest, ADeviceThatGoesAndComesBackIsFoundAgain) {
  makeDisplay();
  turn(1);
  fb->setPresent(false);
  for (int i = 0; i < 10; ++i) turn(1);
  EXPECT_EQ(display->state(), DisplayState::NoDevice);
  EXPECT_EQ(kernel.openDescriptors(), 0u);
  fb->setPresent(true);
  for (int i = 0; i < 10; ++i) turn(7);
  EXPECT_EQ(fb->pixel(0, 0), 0xff000007u);
}

TEST_F(FbdevDisplayTest, SurvivesAFaultOfAnyCall) {
  const auto session = [&] {
    makeDisplay();
    for (int i = 0; i < 12; ++i) turn(1);
    turn(2, 32, 32);
  };
  const auto before = kernel.calls();
  session();
  const auto calls = kernel.calls() - before;
  for (const int error : {EIO, ENODEV, EAGAIN, EINTR, EINVAL, EBUSY, EACCES})
    for (const bool forever : {false, true})
      for (std::uint64_t k = 1; k <= calls; ++k) {
        kernel.inject({.call = kernel.calls() + k, .forever = forever, .error = error});
        session();
        kernel.inject({});
        const auto lifted = kernel.now();
        const std::uint32_t color = 0xff400000 + static_cast<std::uint32_t>(k);
        while (fb->pixel(0, 0) != color && kernel.now() < lifted + milliseconds(600))
          turn(color & 0xffffff);
        ASSERT_LE(kernel.now() - lifted, milliseconds(500)) << "call " << k << " errno " << error;
        ASSERT_EQ(display->state(), DisplayState::Ok);
        display.reset();
        ASSERT_EQ(kernel.openDescriptors(), 0u);
        ASSERT_EQ(kernel.mappings(), 0u);
        ASSERT_EQ(kernel.misuses(), 0u);
      }
}

}  // namespace
}  // namespace depthscope::platform
