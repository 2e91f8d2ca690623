#include "platform/footswitch/footswitch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/fake_kernel/fake_gpio.hpp"
#include "tests/fake_kernel/fake_input_device.hpp"

namespace depthscope::platform {
namespace {

using fake::FakeGpio;
using std::chrono::milliseconds;
using testing::HasSubstr;
using Wire = FakeGpio::Wire;

class FootswitchTest : public ::testing::Test {
 protected:
  FootswitchTest() {
    gpio.addLine("gpiochip0", 3, "DOOR");
    gpio.addLine("gpiochip0", 4, "FOOT");
    gpio.addLine("gpiochip1", 4, "OTHER");
    settings.line = "FOOT";
  }
  void make() { footswitch.emplace(settings, gpio, kernel); }
  /// Time passes, with the service's loop turning as often as it asks to; presses meanwhile.
  int pass(milliseconds time) {
    const auto until = gpio.now + time;
    int presses = turn();
    while (gpio.now < until) {
      const int wait = footswitch->waitAtMost(gpio.now, 50);
      gpio.now += std::clamp<milliseconds>(milliseconds(wait), milliseconds(1),
                                           std::chrono::ceil<milliseconds>(until - gpio.now));
      presses += turn();
    }
    return presses;
  }
  int turn(short events = 0) {
    std::array<pollfd, Footswitch::max_pedals> descriptors{};
    footswitch->addTo(descriptors);
    for (pollfd& d : descriptors) d.revents = events;
    return footswitch->service(gpio.now, descriptors);
  }
  void bounce(Wire from, Wire to, int times) {
    for (int i = 0; i < times; ++i) {
      gpio.setWire("FOOT", to);
      gpio.now += std::chrono::microseconds(300);
      gpio.setWire("FOOT", from);
      gpio.now += std::chrono::microseconds(300);
    }
    gpio.setWire("FOOT", to);
  }

  fake::FakeKernel kernel;
  FakeGpio gpio{FakeGpio::Time(std::chrono::seconds(1000))};
  FootswitchSettings settings;
  std::optional<Footswitch> footswitch;
};

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

class KeyboardPedalTest : public FootswitchTest {
 protected:
  KeyboardPedalTest() {
    settings.line.clear();
    settings.keyboard = "PCsensor FootSwitch";
  }
  void TearDown() override { footswitch.reset(); }  // before the devices it holds open
  fake::FakeInputDevice mouse{kernel, "/dev/input/event0", "Mouse"};
  fake::FakeInputDevice pedal{kernel, "/dev/input/event1", "PCsensor FootSwitch"};
};

TEST_F(KeyboardPedalTest, APressOfAnyKeyCountsOnceHoweverLongItRepeats) {
  make();
  EXPECT_EQ(turn(), 0);
  EXPECT_TRUE(pedal.grabbed());
  EXPECT_FALSE(mouse.grabbed());
  pedal.key(KEY_B, 1);
  EXPECT_EQ(turn(), 1);
  pedal.key(KEY_B, 2);
  pedal.key(KEY_B, 2);
  pedal.key(KEY_B, 0);
  EXPECT_EQ(turn(), 0);
  pedal.key(KEY_B, 1);
  pedal.key(KEY_B, 0);
  pedal.key(KEY_B, 1);
  EXPECT_EQ(turn(), 2);
}

TEST_F(KeyboardPedalTest, OtherKeysThanTheOneOfTheSettingsDoNotCount) {
  settings.keyboard = "/dev/input/event1";
  settings.key = KEY_A;
  make();
  turn();
  pedal.key(KEY_B, 1);
  EXPECT_EQ(turn(), 0);
  pedal.key(KEY_A, 1);
  EXPECT_EQ(turn(), 1);
}

TEST_F(KeyboardPedalTest, AfterAnOverflowTheKeysAreAskedThemselves) {
  make();
  turn();
  pedal.keyUnseen(KEY_B, 1);
  EXPECT_EQ(turn(), 1);
  EXPECT_EQ(footswitch->lost(), 1u);
  pedal.keyUnseen(KEY_B, 0);
  EXPECT_EQ(turn(), 0);
  pedal.key(KEY_B, 1);
  EXPECT_EQ(turn(), 1);
}

TEST_F(KeyboardPedalTest, UnpluggedItIsFoundAgain) {
  make();
  pass(milliseconds(10));
  pedal.setPresent(false);
  pass(milliseconds(1000));
  EXPECT_THAT(footswitch->state(), HasSubstr("No such"));
  EXPECT_EQ(kernel.openDescriptors(), 0u);
  pedal.setPresent(true);
  pass(milliseconds(400));
  EXPECT_EQ(footswitch->state(), "ready");
  pedal.key(KEY_B, 1);
  EXPECT_EQ(turn(), 1);
}

TEST_F(KeyboardPedalTest, ForbiddenOrGrabbedByAnotherItIsTriedAgain) {
  pedal.denied = true;
  make();
  pass(milliseconds(10));
  EXPECT_THAT(footswitch->state(), HasSubstr("denied"));
  pedal.denied = false;
  pedal.grabbed_by_other = true;
  pass(milliseconds(400));
  EXPECT_THAT(footswitch->state(), HasSubstr("busy"));
  EXPECT_EQ(kernel.openDescriptors(), 0u);
  pedal.grabbed_by_other = false;
  pass(milliseconds(400));
  EXPECT_EQ(footswitch->state(), "ready");
}

TEST_F(KeyboardPedalTest, SurvivesAFaultOfAnyCall) {
  const auto session = [&] {
    make();
    for (int i = 0; i < 4; ++i) {
      pass(milliseconds(50));
      pedal.key(KEY_B, 1);
      pass(milliseconds(50));
      pedal.key(KEY_B, 0);
    }
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
        pass(milliseconds(400));
        ASSERT_EQ(footswitch->state(), "ready") << "call " << k << " errno " << error;
        pedal.key(KEY_B, 1);
        ASSERT_EQ(pass(milliseconds(50)), 1);
        pedal.key(KEY_B, 0);
        footswitch.reset();
        ASSERT_EQ(kernel.openDescriptors(), 0u);
        ASSERT_EQ(kernel.misuses(), 0u);
      }
}

}  // namespace
}  // namespace depthscope::platform
