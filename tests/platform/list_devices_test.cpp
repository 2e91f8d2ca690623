#include "platform/tool/list_displays.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "platform/tool/devices_command.hpp"
#include "tests/fake_kernel/fake_gpio.hpp"
#include "tests/fake_kernel/fake_input_device.hpp"
#include "tests/fake_kernel/fake_kms_card.hpp"

namespace depthscope::platform {
namespace {

using fake::FakeKmsCard;
using fake::makeMode;
using testing::HasSubstr;

class ListDevices : public ::testing::Test {
 protected:
  std::string displays() {
    std::ostringstream out;
    printDisplays(out, kernel, settings, 1280, 720, 30);
    return out.str();
  }
  fake::FakeKernel kernel;
  DisplaySettings settings;
};

TEST_F(ListDevices, NamesConnectorsModesAndTheChoice) {
  FakeKmsCard first(kernel, "card0", {{DRM_MODE_CONNECTOR_HDMIA, 1, false, {}}});
  FakeKmsCard second(kernel, "card1",
                     {{DRM_MODE_CONNECTOR_DisplayPort,
                       2,
                       true,
                       {makeMode(1920, 1080, 60, true), makeMode(1280, 720, 60)}}});
  const std::string text = displays();
  EXPECT_THAT(text, HasSubstr("/dev/dri/card0\n  HDMI-A-1  no monitor\n"));
  EXPECT_THAT(text, HasSubstr("/dev/dri/card1\n  DP-2\n    1920x1080@60.00 preferred\n"));
  EXPECT_THAT(text, HasSubstr("display.device = \"auto\": /dev/dri/card1, DP-2, 1280x720@60.00\n"));
  EXPECT_EQ(kernel.openDescriptors(), 0u);
  EXPECT_TRUE(second.consoleShown());
  settings.device = "/dev/dri/card0";
  EXPECT_THAT(displays(),
              HasSubstr("\"/dev/dri/card0\", display.connector = \"auto\": no monitor"));
}

TEST_F(ListDevices, SaysWhatIsMissing) {
  EXPECT_THAT(displays(), HasSubstr("no graphics card found"));
  FakeKmsCard card(kernel, "card0", {{}});
  card.atomic = false;
  EXPECT_THAT(displays(), HasSubstr("/dev/dri/card0: its driver has no atomic modesetting"));
}

TEST_F(ListDevices, NamesWhatAPedalMayBe) {
  fake::FakeGpio gpio(kernel.now());
  std::ostringstream some;
  gpio.addLine("gpiochip0", 4, "FOOT");
  fake::FakeInputDevice pedal(kernel, "/dev/input/event3", "PCsensor FootSwitch");
  printPedals(some, kernel, gpio);
  EXPECT_EQ(some.str(),
            "keyboard  /dev/input/event3  PCsensor FootSwitch\n"
            "GPIO line FOOT: gpiochip0 offset 4\n");
}

}  // namespace
}  // namespace depthscope::platform
