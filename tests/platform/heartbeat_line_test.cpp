#include "platform/daemon/heartbeat_line.hpp"

#include <gtest/gtest.h>

#include "tests/fake_kernel/fake_gpio.hpp"

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;

class HeartbeatLineTest : public testing::Test {
 protected:
  HeartbeatLineTest() { gpio.addLine("gpiochip0", 4, "RELAY"); }

  static HeartbeatSettings settings() {
    HeartbeatSettings s;
    s.line = "RELAY";
    return s;
  }
  /// For so long, with a picture every `picture_every` (zero: none); the changes of the line's
  /// wire.
  int changes(HeartbeatLine& heartbeat, milliseconds time, milliseconds picture_every) {
    int n = 0;
    for (milliseconds t{0}; t < time; t += milliseconds(5)) {
      gpio.now += milliseconds(5);
      if (picture_every.count() > 0 && t.count() % picture_every.count() == 0) ++presented;
      const auto before = line().wire;
      heartbeat.service(gpio.now, presented);
      n += line().wire != before;
    }
    return n;
  }
  fake::FakeGpio::Line& line() { return gpio.lines.at("RELAY"); }

  fake::FakeGpio gpio{fake::FakeGpio::Time(std::chrono::seconds(50))};
  std::uint64_t presented = 0;
};

TEST_F(HeartbeatLineTest, MovesWhilePicturesGoOutAndStopsWithThem) {
  HeartbeatLine heartbeat(settings(), gpio);
  heartbeat.service(gpio.now, 0);  // which opens the line
  EXPECT_EQ(changes(heartbeat, milliseconds(1000), milliseconds(0)), 0) << "no picture yet";
  EXPECT_NEAR(changes(heartbeat, milliseconds(1000), milliseconds(100)), 10, 1);
  EXPECT_LE(changes(heartbeat, milliseconds(1000), milliseconds(0)), 1) << "the loop hangs";
  EXPECT_EQ(changes(heartbeat, milliseconds(5000), milliseconds(0)), 0);
  EXPECT_NEAR(changes(heartbeat, milliseconds(1000), milliseconds(100)), 10, 1);
}

TEST_F(HeartbeatLineTest, MovesAtMostTwentyTimesASecondHoweverManyPicturesThereAre) {
  HeartbeatLine heartbeat(settings(), gpio);
  EXPECT_NEAR(changes(heartbeat, milliseconds(1000), milliseconds(5)), 20, 1);
}

TEST_F(HeartbeatLineTest, IsReleasedWithItsOwner) {
  {
    HeartbeatLine heartbeat(settings(), gpio);
    changes(heartbeat, milliseconds(100), milliseconds(10));
    EXPECT_TRUE(line().requested);
    EXPECT_TRUE(line().output);
  }
  EXPECT_FALSE(line().requested);
}

TEST_F(HeartbeatLineTest, ALineThatIsMissingOrGoesAwayIsFoundWhenItIsThere) {
  gpio.present = false;
  HeartbeatLine heartbeat(settings(), gpio);
  EXPECT_EQ(changes(heartbeat, milliseconds(500), milliseconds(35)), 0);
  gpio.present = true;
  changes(heartbeat, milliseconds(1000), milliseconds(35));
  EXPECT_GT(changes(heartbeat, milliseconds(1000), milliseconds(35)), 10);
  gpio.present = false;
  EXPECT_EQ(changes(heartbeat, milliseconds(500), milliseconds(35)), 0);
  EXPECT_FALSE(line().requested);
  gpio.present = true;
  changes(heartbeat, milliseconds(1000), milliseconds(35));
  EXPECT_GT(changes(heartbeat, milliseconds(1000), milliseconds(35)), 10);
}

TEST_F(HeartbeatLineTest, StartsAtItsInactiveLevel) {
  HeartbeatSettings low = settings();
  low.active_low = true;
  HeartbeatLine heartbeat(low, gpio);
  changes(heartbeat, milliseconds(100), milliseconds(0));
  EXPECT_EQ(line().wire, fake::FakeGpio::Wire::High);
}

TEST_F(HeartbeatLineTest, WithoutALineNothingIsTouched) {
  HeartbeatLine heartbeat({}, gpio);
  EXPECT_EQ(changes(heartbeat, milliseconds(500), milliseconds(35)), 0);
  EXPECT_FALSE(line().requested);
}

}  // namespace
}  // namespace depthscope::platform
