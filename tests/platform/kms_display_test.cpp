// The display on a card that the fake kernel acts out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kms_fixture.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

using fake::FakeKmsCard;
using fake::makeMode;
using std::chrono::milliseconds;

TEST_F(KmsDisplayTest, ShowsEachPictureAtTheNextVblank) {
  makeDisplay();
  EXPECT_EQ(display->state(), DisplayState::Starting);
  for (std::uint32_t i = 0; i < 3; ++i) EXPECT_TRUE(turn(0x102030));  // the mode is being set
  for (std::uint32_t i = 1; i < 20; ++i) {
    EXPECT_TRUE(turn(0x102030 + i));
    EXPECT_EQ(card->pixel(0, 0), 0x102030 + i);
    EXPECT_EQ(card->pixel(width - 1, height - 1), 0x102030 + i);
  }
  EXPECT_EQ(display->state(), DisplayState::Ok);
  EXPECT_EQ(card->modesets(), 1u);
  EXPECT_EQ(card->timesSwitchedOff(), 0u);
  EXPECT_EQ(card->clients(), 1u);
  display.reset();
  expectClean();
}

TEST_F(KmsDisplayTest, NeverDrawsIntoTheBufferThatIsOnScreen) {
  makeDisplay();
  for (int i = 0; i < 4; ++i) turn(0x111111);
  ASSERT_EQ(card->pixel(0, 0), 0x111111u);
  card->vblanks = false;  // from here on nothing reaches the screen
  for (std::uint32_t i = 0; i < 5; ++i) {
    offer(0x222222 + i);
    EXPECT_EQ(card->pixel(0, 0), 0x111111u);
  }
}

TEST_F(KmsDisplayTest, TakesThePlanesOwnByteOrderWhereItCan) {
  for (const std::uint32_t format :
       {DRM_FORMAT_XBGR8888, DRM_FORMAT_ABGR8888, DRM_FORMAT_XRGB8888, DRM_FORMAT_ARGB8888}) {
    display.reset();
    plugCard({format});
    makeDisplay();
    for (int i = 0; i < 3; ++i) turn(0xa0b0c0);
    EXPECT_EQ(card->pixel(3, 5), 0xa0b0c0u) << std::hex << format;
  }
}

TEST_F(KmsDisplayTest, GoesToTheNextFormatWhenTheDriverRefusesOne) {
  plugCard({DRM_FORMAT_XBGR8888, DRM_FORMAT_XRGB8888});
  card->refused_framebuffer_formats = {DRM_FORMAT_XBGR8888};
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(0xa0b0c0);
  EXPECT_EQ(card->pixel(3, 5), 0xa0b0c0u);
  display.reset();
  expectClean();
}

TEST_F(KmsDisplayTest, SaysWhenAPictureWasShown) {
  makeDisplay(60);
  for (int i = 0; i < 3; ++i) turn(0x000001);
  while (display->takeShown()) {
  }
  const auto before = kernel.now();
  offer(0x000002);
  const auto shown_index = index;
  kernel.advance(milliseconds(20));
  const auto shown = display->takeShown();
  ASSERT_TRUE(shown);
  EXPECT_EQ(shown->index, shown_index);
  EXPECT_GE(shown->submitted, before);
  EXPECT_GT(shown->shown, shown->submitted);
  EXPECT_LE(shown->shown - shown->submitted, milliseconds(17));
  EXPECT_FALSE(display->takeShown());
}

TEST_F(KmsDisplayTest, TheNewestPictureWinsWhenTheMonitorIsSlow) {
  settings.mode = "64x48@50";
  makeDisplay(200);
  for (std::uint32_t i = 0; i < 40; ++i) {
    EXPECT_TRUE(offer(i));
    kernel.advance(milliseconds(2));
  }
  const std::uint32_t newest = 39;
  kernel.advance(milliseconds(25));
  display->takeShown();
  kernel.advance(milliseconds(25));
  EXPECT_EQ(card->pixel(0, 0), newest);
}

TEST_F(KmsDisplayTest, NeverHoldsTheLoopUpForLongerThanHalfAPicture) {
  makeDisplay(60);
  for (int i = 0; i < 5; ++i) turn(1);
  card->vblanks = false;
  for (int i = 0; i < 100; ++i) {
    const auto before = kernel.now();
    offer(2);
    EXPECT_LE(kernel.now() - before, milliseconds(17));
    kernel.advance(frame_time);
  }
  EXPECT_NE(display->state(), DisplayState::Ok);
  card->vblanks = true;
  for (int i = 0; i < 15; ++i) turn(3);
  EXPECT_EQ(card->pixel(0, 0), 3u);
  EXPECT_EQ(display->state(), DisplayState::Ok);
}

TEST_F(KmsDisplayTest, CentresAPictureInALargerModeAndScalesALargerPictureDown) {
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(0x808080, 100, 90);
  EXPECT_EQ(display->mode().width, 128);
  EXPECT_EQ(card->pixel(13, 50), 0u);
  EXPECT_EQ(card->pixel(14, 3), 0x808080u);
  EXPECT_EQ(card->pixel(113, 92), 0x808080u);
  EXPECT_EQ(card->pixel(114, 93), 0u);
  for (int i = 0; i < 4; ++i) turn(0x404040, 256, 96);
  EXPECT_EQ(display->mode().width, 128);
  EXPECT_EQ(card->pixel(14, 3), 0u);
  EXPECT_EQ(card->pixel(0, 24), 0x404040u);
  EXPECT_EQ(card->pixel(127, 71), 0x404040u);
  EXPECT_EQ(card->pixel(127, 72), 0u);
}

TEST_F(KmsDisplayTest, ChangesTheModeWithThePictureWithoutSwitchingTheMonitorOff) {
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  EXPECT_EQ(card->mode()->hdisplay, width);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(turn(2, 128, 96));
  EXPECT_EQ(card->mode()->hdisplay, 128);
  EXPECT_EQ(card->pixel(127, 95), 2u);
  EXPECT_EQ(card->modesets(), 2u);
  EXPECT_EQ(card->timesSwitchedOff(), 0u);
  EXPECT_EQ(card->buffers(), 3u);
  display.reset();
  expectClean();
}

TEST_F(KmsDisplayTest, TakesTheNextBestModeWhenTheDriverRefusesTheBest) {
  card->refused_width = width;
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(5);
  EXPECT_EQ(card->mode()->hdisplay, 128);
  EXPECT_EQ(card->pixel(64, 48), 5u);
}

TEST_F(KmsDisplayTest, GoesOnWithoutAMonitorAndLightsItOnceItIsPluggedIn) {
  card->setConnected(0, false);
  makeDisplay();
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(turn(1));
  EXPECT_EQ(display->state(), DisplayState::NoMonitor);
  const auto probes = card->probes();
  for (int i = 0; i < 60; ++i) turn(1);
  EXPECT_EQ(card->probes(), probes);  // waiting asks no monitor: that would hold the loop up
  card->setConnected(0, true);
  const auto plugged = kernel.now();
  while (card->pixel(0, 0) != 7 && kernel.now() < plugged + milliseconds(500)) turn(7);
  EXPECT_EQ(card->pixel(0, 0), 7u);
  display->takeShown();
  EXPECT_EQ(display->state(), DisplayState::Ok);
}

TEST_F(KmsDisplayTest, LightsAnotherMonitorInItsOwnModeAfterAChangeOfMonitors) {
  makeDisplay();
  for (int i = 0; i < 5; ++i) turn(1);
  card->setConnected(0, false);
  for (int i = 0; i < 8; ++i) turn(1);
  EXPECT_EQ(display->state(), DisplayState::NoMonitor);
  EXPECT_EQ(display->mode().width, 0);
  card->setModes(0, {makeMode(160, 100, 60, true)});
  card->setConnected(0, true);
  for (int i = 0; i < 12; ++i) turn(9);
  EXPECT_EQ(display->state(), DisplayState::Ok);
  EXPECT_EQ(card->mode()->hdisplay, 160);
  EXPECT_EQ(card->pixel(80, 50), 9u);
  display.reset();
  expectClean();
}

TEST_F(KmsDisplayTest, SurvivesTheCardBeingTakenAwayAndPutBack) {
  makeDisplay();
  for (int i = 0; i < 5; ++i) turn(1);
  card->setPresent(false);
  for (int i = 0; i < 10; ++i) turn(1);
  EXPECT_EQ(display->state(), DisplayState::NoDevice);
  EXPECT_EQ(kernel.openDescriptors(), 0u);
  card->setPresent(true);
  for (int i = 0; i < 12; ++i) turn(4);
  EXPECT_EQ(display->state(), DisplayState::Ok);
  EXPECT_EQ(card->pixel(0, 0), 4u);
}

TEST_F(KmsDisplayTest, WaitsForAnotherProgramToLetGoOfTheCard) {
  card->other_master = true;
  makeDisplay();
  for (int i = 0; i < 10; ++i) turn(1);
  EXPECT_EQ(display->state(), DisplayState::PermissionDenied);
  card->other_master = false;
  for (int i = 0; i < 12; ++i) turn(4);
  EXPECT_EQ(display->state(), DisplayState::Ok);
}

TEST_F(KmsDisplayTest, SaysSoWhenTheDriverKnowsNoAtomicModesetting) {
  card->atomic = false;
  makeDisplay();
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(turn(1));
  EXPECT_EQ(display->state(), DisplayState::Unsupported);
}

TEST_F(KmsDisplayTest, SaysSoWhenThereIsNoCard) {
  card->setPresent(false);
  makeDisplay();
  EXPECT_FALSE(turn(1));
  EXPECT_EQ(display->state(), DisplayState::NoDevice);
}

TEST_F(KmsDisplayTest, TakesTheFirstCardThatHasAMonitor) {
  card->setConnected(0, false);
  FakeKmsCard second(kernel, "card1",
                     {{DRM_MODE_CONNECTOR_DisplayPort, 1, false, {}},
                      {DRM_MODE_CONNECTOR_DisplayPort, 2, true, {makeMode(width, height, 30)}}});
  makeDisplay();
  for (int i = 0; i < 4; ++i) turn(6);
  EXPECT_EQ(second.pixel(1, 1), 6u);
  EXPECT_TRUE(second.lit(1));
  EXPECT_TRUE(card->consoleShown());
  display.reset();
  EXPECT_TRUE(second.consoleShown());
}

TEST_F(KmsDisplayTest, KeepsToTheCardAndConnectorOfTheSettings) {
  FakeKmsCard second(kernel, "card1",
                     {{DRM_MODE_CONNECTOR_DisplayPort, 1, true, {makeMode(width, height, 30)}},
                      {DRM_MODE_CONNECTOR_DisplayPort, 2, false, {makeMode(width, height, 30)}}});
  kernel.link("/dev/dri/by-path/gpu", "../card1");
  kernel.link("../card1", "/dev/dri/card1");
  settings.device = "/dev/dri/by-path/gpu";
  settings.connector = "DP-2";
  makeDisplay();
  for (int i = 0; i < 8; ++i) turn(6);
  EXPECT_EQ(display->state(), DisplayState::NoMonitor);
  second.setConnected(1, true);
  for (int i = 0; i < 12; ++i) turn(6);
  EXPECT_EQ(display->state(), DisplayState::Ok);
  EXPECT_TRUE(second.lit(1));
  EXPECT_FALSE(second.lit(0));
  display.reset();
}

TEST_F(KmsDisplayTest, RefusesAModeSettingThatMakesNoSense) {
  for (const char* mode : {"", "big", "1920", "1920x", "0x1080", "1920x1080@", "1920x1080@60Hz"}) {
    settings.mode = mode;
    EXPECT_THROW(makeDisplay(), InputError) << mode;
  }
}

TEST_F(KmsDisplayTest, SurvivesAFaultOfAnyCall) {
  const auto session = [&] {
    // Starting up, a change of mode, another monitor.
    for (int i = 0; i < 6; ++i) turn(1);
    for (int i = 0; i < 4; ++i) turn(2, 128, 96);
    card->setConnected(0, false);
    for (int i = 0; i < 6; ++i) turn(1);
    card->setConnected(0, true);
    for (int i = 0; i < 10; ++i) turn(1);
  };
  expectFaultsSurvived([&] { makeDisplay(); }, session, [&](std::uint32_t color) { turn(color); },
                       [&] {
                         display->takeShown();
                         ASSERT_EQ(display->state(), DisplayState::Ok);
                         ASSERT_LE(card->clients(), 1u);
                         ASSERT_LE(card->buffers(), 6u);
                       });
}

}  // namespace
}  // namespace depthscope::platform
