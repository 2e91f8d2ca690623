#include <gmock/gmock.h>

#include "footswitch_fixture.hpp"

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

TEST_F(FootswitchTest, WithoutAPedalThereIsNothingToDo) {
  settings.line.clear();
  make();
  EXPECT_EQ(footswitch->state(), "off");
  EXPECT_EQ(footswitch->pedals(), 0u);
  EXPECT_EQ(footswitch->service(gpio.now, {}), 0);
}

TEST_F(FootswitchTest, APressCountsOnceWhenTheContactIsSteady) {
  make();
  EXPECT_EQ(pass(milliseconds(100)), 0);
  EXPECT_EQ(footswitch->state(), "ready");
  gpio.setWire("FOOT", Wire::High);
  EXPECT_EQ(pass(milliseconds(19)), 0);
  EXPECT_EQ(pass(milliseconds(2)), 1);
  EXPECT_EQ(pass(milliseconds(500)), 0);
  gpio.setWire("FOOT", Wire::Low);
  EXPECT_EQ(pass(milliseconds(500)), 0);
  gpio.setWire("FOOT", Wire::High);
  EXPECT_EQ(pass(milliseconds(100)), 1);
  EXPECT_EQ(footswitch->presses(), 2u);
  EXPECT_EQ(footswitch->lost(), 0u);
}

TEST_F(FootswitchTest, BouncingIsOnePressAndNoneOnTheWayBack) {
  make();
  pass(milliseconds(10));
  bounce(Wire::Low, Wire::High, 5);
  EXPECT_EQ(pass(milliseconds(100)), 1);
  bounce(Wire::High, Wire::Low, 5);
  EXPECT_EQ(pass(milliseconds(100)), 0);
}

TEST_F(FootswitchTest, ASpikeShorterThanTheDebouncingIsNoPress) {
  make();
  pass(milliseconds(10));
  gpio.setWire("FOOT", Wire::High);
  gpio.now += milliseconds(5);
  gpio.setWire("FOOT", Wire::Low);
  EXPECT_EQ(pass(milliseconds(100)), 0);
}

TEST_F(FootswitchTest, APressThatCameAndWentWhileTheServiceWasBusyCounts) {
  make();
  pass(milliseconds(10));
  for (int i = 0; i < 2; ++i) {
    gpio.setWire("FOOT", Wire::High);
    gpio.now += milliseconds(200);
    gpio.setWire("FOOT", Wire::Low);
    gpio.now += milliseconds(200);
  }
  EXPECT_EQ(turn(), 2);
}

TEST_F(FootswitchTest, TheKernelsDebouncingTakesThePlaceOfOurs) {
  gpio.debounces = true;
  make();
  pass(milliseconds(10));
  gpio.setWire("FOOT", Wire::High);
  EXPECT_EQ(turn(), 1);
}

TEST_F(FootswitchTest, BiasAndActiveLowMakeAnOpenSwitchInactive) {
  settings.bias = GpioBias::PullUp;
  settings.active_low = true;
  make();
  EXPECT_EQ(pass(milliseconds(100)), 0);
  gpio.setWire("FOOT", Wire::Low);  // the switch closes to ground
  EXPECT_EQ(pass(milliseconds(100)), 1);
  gpio.setWire("FOOT", Wire::Open);
  EXPECT_EQ(pass(milliseconds(100)), 0);
}

TEST_F(FootswitchTest, APedalThatIsHeldDownWhileItIsFoundWasNotPressed) {
  gpio.setWire("FOOT", Wire::High);
  make();
  EXPECT_EQ(pass(milliseconds(200)), 0);
  gpio.setWire("FOOT", Wire::Low);
  pass(milliseconds(100));
  gpio.setWire("FOOT", Wire::High);
  EXPECT_EQ(pass(milliseconds(100)), 1);
}

TEST_F(FootswitchTest, TheLineMayBeNamedByChipAndOffset) {
  settings.chip = "gpiochip0";
  settings.line = "4";
  make();
  pass(milliseconds(10));
  EXPECT_TRUE(gpio.lines["FOOT"].requested);
  settings.chip = "gpiochip1";
  settings.line = "FOOT";
  make();
  EXPECT_THAT((pass(milliseconds(10)), footswitch->state()), HasSubstr("No such file"));
}

TEST_F(FootswitchTest, ALostEdgeIsNoticedByTheLevel) {
  make();
  pass(milliseconds(10));
  gpio.drop_edges = true;
  gpio.setWire("FOOT", Wire::High);
  gpio.drop_edges = false;
  EXPECT_EQ(pass(milliseconds(200)), 1);
  EXPECT_EQ(footswitch->lost(), 1u);
  gpio.setWire("FOOT", Wire::Low);
  pass(milliseconds(200));
  EXPECT_EQ(footswitch->lost(), 1u);
}

TEST_F(FootswitchTest, TwoEdgesAlikeMeanThatOneBetweenThemWasLost) {
  make();
  pass(milliseconds(10));
  gpio.setWire("FOOT", Wire::High);
  gpio.now += milliseconds(1);
  gpio.drop_edges = true;
  gpio.setWire("FOOT", Wire::Low);
  gpio.drop_edges = false;
  gpio.setWire("FOOT", Wire::High);
  EXPECT_EQ(pass(milliseconds(100)), 1);
  EXPECT_EQ(footswitch->lost(), 1u);
}

TEST_F(FootswitchTest, CountedEdgesTellHowManyWereLost) {
  gpio.counts_edges = true;
  make();
  pass(milliseconds(10));
  gpio.setWire("FOOT", Wire::High);
  turn();
  gpio.drop_edges = true;
  for (int i = 0; i < 3; ++i) {
    gpio.setWire("FOOT", Wire::Low);
    gpio.setWire("FOOT", Wire::High);
  }
  gpio.drop_edges = false;
  gpio.setWire("FOOT", Wire::Low);
  turn();
  EXPECT_EQ(footswitch->lost(), 6u);
}

TEST_F(FootswitchTest, AFullQueueLosesEdgesButNotTheLevel) {
  make();
  pass(milliseconds(10));
  bounce(Wire::Low, Wire::High, 40);
  EXPECT_EQ(pass(milliseconds(300)), 1);
  EXPECT_GE(footswitch->lost(), 1u);
  gpio.setWire("FOOT", Wire::Low);
  EXPECT_EQ(pass(milliseconds(300)), 0);
}

TEST_F(FootswitchTest, AChipThatGoesAndComesBackIsFoundAgain) {
  make();
  pass(milliseconds(100));
  gpio.present = false;
  EXPECT_EQ(pass(milliseconds(2000)), 0);
  EXPECT_THAT(footswitch->state(), HasSubstr("FOOT: No such"));
  EXPECT_FALSE(gpio.lines["FOOT"].requested);
  EXPECT_LE(gpio.tries, 10);
  gpio.present = true;
  pass(milliseconds(400));
  EXPECT_EQ(footswitch->state(), "ready");
  gpio.setWire("FOOT", Wire::High);
  EXPECT_EQ(pass(milliseconds(100)), 1);
}

TEST_F(FootswitchTest, ALineThatHangsUpIsLetGo) {
  make();
  pass(milliseconds(100));
  turn(POLLERR);
  EXPECT_FALSE(gpio.lines["FOOT"].requested);
  pass(milliseconds(400));
  EXPECT_EQ(footswitch->state(), "ready");
}

TEST_F(FootswitchTest, ALineThatIsTakenOrForbiddenIsTriedAgain) {
  gpio.lines["FOOT"].requested = true;
  make();
  pass(milliseconds(400));
  EXPECT_THAT(footswitch->state(), HasSubstr("busy"));
  gpio.lines["FOOT"].requested = false;
  gpio.denied = true;
  pass(milliseconds(400));
  EXPECT_THAT(footswitch->state(), HasSubstr("denied"));
  gpio.denied = false;
  pass(milliseconds(400));
  EXPECT_EQ(footswitch->state(), "ready");
}

TEST_F(FootswitchTest, AnOutputLineStartsInactiveAndTakesLogicalLevels) {
  std::unique_ptr<GpioOutput> output;
  ASSERT_EQ(gpio.openOutput({"", "DOOR", GpioBias::AsIs, true}, output), 0);
  EXPECT_EQ(gpio.lines["DOOR"].wire, Wire::High);
  EXPECT_EQ(output->set(true), 0);
  EXPECT_EQ(gpio.lines["DOOR"].wire, Wire::Low);
}

}  // namespace
}  // namespace depthscope::platform
