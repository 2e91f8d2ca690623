// The latency that the loop measures against the one that the pictures themselves tell: a clock
// drawn into what goes in is read from what comes out.
#include <gtest/gtest.h>

#include "tests/platform/binary_clock.hpp"
#include "tests/platform/video_loop_fixture.hpp"

namespace depthscope::platform {
namespace {

overlay::OverlaySettings withoutInset() {
  overlay::OverlaySettings settings;
  settings.inset = false;  // it would cover the clock
  return settings;
}

class LatencyClock : public VideoLoopFixture {
 protected:
  LatencyClock() : VideoLoopFixture(withoutInset()) {
    source.paint = [this](capture::Frame& frame) { clock.draw(frame, frame.capture_time); };
  }
  /// Every picture went out once and in order; the longest delay that they tell.
  std::chrono::nanoseconds readPictures() {
    std::chrono::nanoseconds longest{0};
    Time before{};
    for (const RecordingDisplay::Shown& shown : display.shown) {
      const auto captured = clock.read(shown.pixels);
      if (!captured) {
        ADD_FAILURE() << "no clock in picture " << shown.index;
        continue;
      }
      EXPECT_GT(*captured, before) << "picture " << shown.index << " is not a new one";
      before = *captured;
      longest = std::max<std::chrono::nanoseconds>(longest, shown.at - *captured);
    }
    return longest;
  }
  /// What the loop itself says of the last pictures.
  double longestByTheLoop_ms() {
    while (report.frames.load() % 30 != 1) showPicture(false);
    FrameClockSummary summary;
    EXPECT_TRUE(report.times.read(summary));
    return summary.video_delay.max;
  }
  void expectAgreement() {
    const double by_loop = longestByTheLoop_ms();
    const double by_pictures = std::chrono::duration<double, std::milli>(readPictures()).count();
    EXPECT_NEAR(by_pictures, by_loop, 0.01);
  }

  const BinaryClock clock{160, 120};
};

TEST_F(LatencyClock, AgreesWithTheLoopsOwnMeasurement) {
  for (int i = 0; i < 40; ++i) showPicture(false);
  expectAgreement();
  EXPECT_LE(readPictures(), milliseconds(3));
}

TEST_F(LatencyClock, IsThereUnderTheOverlayAndAgreesWithArRunningAndGone) {
  link.setAlive(true);
  sendSurface();
  for (int i = 0; i < 40; ++i) showPicture(true);
  link.setAlive(false);
  for (int i = 0; i < 20; ++i) showPicture(false);
  expectAgreement();
}

TEST_F(LatencyClock, TellsADelayThatTheLoopCannotSeeComing) {
  for (int i = 0; i < 10; ++i) showPicture(false);
  system.advance(milliseconds(50));  // the processor was taken away
  for (int i = 0; i < 10; ++i) showPicture(false);
  expectAgreement();
  EXPECT_GE(readPictures(), milliseconds(15));
}

TEST_F(LatencyClock, AnOldPictureThatIsShownAgainTellsItsAge) {
  showPicture(false);
  const Time captured = next;
  ASSERT_TRUE(loop->turn());
  // Darkened to half: the clock can still be read at half the level.
  std::vector<std::uint8_t> brighter = last().pixels;
  for (std::uint8_t& byte : brighter) byte = static_cast<std::uint8_t>(std::min(255, 2 * byte));
  ASSERT_TRUE(clock.read(brighter));
  EXPECT_EQ(*clock.read(brighter), captured);
  EXPECT_GE(last().at - captured, milliseconds(80));
}

}  // namespace
}  // namespace depthscope::platform
