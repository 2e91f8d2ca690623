#include <gmock/gmock.h>

#include "footswitch_fixture.hpp"
#include "tests/fake_kernel/fake_input_device.hpp"

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

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
