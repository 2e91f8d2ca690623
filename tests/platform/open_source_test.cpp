#include "platform/daemon/open_source.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "platform/tool/devices_command.hpp"
#include "tests/fake_kernel/fake_v4l2_card.hpp"
#include "tests/platform/expect_input_error.hpp"

namespace depthscope::platform {
namespace {

using testing::HasSubstr;

CaptureSettings withCard() {
  CaptureSettings settings;
  settings.card.device = "auto";
  return settings;
}

TEST(CheckCapture, WantsOneSourceOfPictures) {
  EXPECT_NO_THROW(checkCapture(withCard()));
  CaptureSettings clip;
  clip.input = "clip.mp4";
  EXPECT_NO_THROW(checkCapture(clip));
  EXPECT_INPUT_ERROR(checkCapture(CaptureSettings()), HasSubstr("capture.device"),
                     HasSubstr("capture.input"), HasSubstr("missing"));
  CaptureSettings both = withCard();
  both.input = "clip.mp4";
  EXPECT_INPUT_ERROR(checkCapture(both), HasSubstr("capture.device"), HasSubstr("capture.input"),
                     HasSubstr("clip.mp4"));
}

TEST(CheckCapture, NamesTheKeyOfWhatACardCannotBe) {
  CaptureSettings settings = withCard();
  settings.card.device = "HDMI";
  EXPECT_INPUT_ERROR(checkCapture(settings), HasSubstr("capture.device"), HasSubstr("HDMI"),
                     HasSubstr("name:TEXT"));
  settings = withCard();
  settings.card.pixel_format = "H264";
  EXPECT_INPUT_ERROR(checkCapture(settings), HasSubstr("capture.pixel_format"), HasSubstr("H264"),
                     HasSubstr("NV12"));
  settings = withCard();
  settings.card.edid = "/nowhere/edid.bin";
  EXPECT_INPUT_ERROR(checkCapture(settings), HasSubstr("capture.edid"),
                     HasSubstr("/nowhere/edid.bin"));
  settings = withCard();
  settings.faults = "faults.txt";
  EXPECT_INPUT_ERROR(checkCapture(settings), HasSubstr("capture.faults"),
                     HasSubstr("capture.input"));
}

TEST(CardSettings, TakeTheCamerasSizeUnlessOneIsSet) {
  CameraModel camera;
  camera.width = 1280;
  camera.height = 720;
  CaptureSettings settings = withCard();
  settings.buffers = 12;
  EXPECT_EQ(cardSettings(settings, camera).width, 1280);
  EXPECT_EQ(cardSettings(settings, camera).height, 720);
  EXPECT_EQ(cardSettings(settings, camera).buffers, 12);
  settings.card.width = 640;
  EXPECT_EQ(cardSettings(settings, camera).width, 640);
}

TEST(PrintDevices, TellsWhatIsThereAndWhatWouldBeChosen) {
  fake::FakeKernel kernel;
  fake::FakeV4l2Card card(kernel, {});
  kernel.plug("/dev/video0", card);
  std::ostringstream out;
  printDevices(out, kernel, withCard().card);
  EXPECT_EQ(out.str(),
            "/dev/video0  Fake HDMI\n"
            "  driver    fake\n"
            "  bus       PCI:0000:01:00.0\n"
            "  input     0 \"HDMI\": ok (is set)\n"
            "  signal    64x48 at 50.00\n"
            "  EDID      can be set\n"
            "  formats\n"
            "    YUYV  some format\n"
            "    NV12  some format\n"
            "\n"
            "capture.device = \"auto\": /dev/video0, input \"HDMI\", YUYV 64x48\n");
}

TEST(PrintDevices, SaysThatThereIsNone) {
  fake::FakeKernel kernel;
  std::ostringstream out;
  printDevices(out, kernel, withCard().card);
  EXPECT_EQ(out.str(), "no capture device found\n");
}

}  // namespace
}  // namespace depthscope::platform
