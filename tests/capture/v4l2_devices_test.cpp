#include "capture/v4l2_devices.hpp"

#include "tests/capture/v4l2_test_card.hpp"

namespace depthscope::capture {
namespace {

TEST_F(V4l2Test, DevicesAreListedWithWhatTheyCan) {
  plug({.name = "Grabber",
        .bus = "PCI:1",
        .inputs = {"DVI", "HDMI"},
        .formats = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_SBGGR8}});
  FakeV4l2Card webcam(kernel, {.name = "Webcam",
                               .digital = false,
                               .formats = {V4L2_PIX_FMT_MJPEG},
                               .sizes = {{1280, 720}, {640, 480}},
                               .compressed_fps = 30});
  kernel.plug("/dev/video10", webcam);
  FakeV4l2Card locked(kernel, {});
  locked.refuseOpen(EACCES);
  kernel.plug("/dev/video2", locked);
  kernel.link("/dev/v4l/by-path/pci-1", "../../video0");
  kernel.link("/dev/v4l/by-path/pci-9", "../../video10");

  const auto devices = listCaptureDevices(kernel);
  ASSERT_EQ(devices.size(), 3u);
  EXPECT_EQ(devices[0].path, "/dev/video0");
  EXPECT_EQ(devices[0].card, "Grabber");
  EXPECT_EQ(devices[0].bus, "PCI:1");
  EXPECT_EQ(devices[0].links, std::vector<std::string>{"/dev/v4l/by-path/pci-1"});
  ASSERT_EQ(devices[0].inputs.size(), 2u);
  EXPECT_EQ(devices[0].inputs[1].name, "HDMI");
  EXPECT_TRUE(devices[0].inputs[0].current);
  EXPECT_EQ(devices[0].signal, "64x48 at 50.00");
  EXPECT_TRUE(devices[0].has_edid);
  ASSERT_EQ(devices[0].formats.size(), 2u);
  EXPECT_EQ(devices[0].formats[0].fourcc, "YUYV");
  EXPECT_TRUE(devices[0].formats[0].usable);
  EXPECT_FALSE(devices[0].formats[1].usable);
  EXPECT_EQ(devices[1].path, "/dev/video2");
  EXPECT_EQ(devices[1].error, "Permission denied");
  EXPECT_EQ(devices[2].path, "/dev/video10") << "in the order of numbers";
  EXPECT_EQ(devices[2].formats[0].sizes,
            (std::vector<std::string>{"1280x720 at 30", "640x480 at 30"}));
  EXPECT_FALSE(devices[2].has_edid);
}

TEST_F(V4l2Test, AListedSignalThatIsMissingIsSaid) {
  plug({});
  card->setSignal(FakeV4l2Card::Signal::Missing);
  EXPECT_EQ(listCaptureDevices(kernel)[0].signal, "the input finds no signal");
  EXPECT_EQ(listCaptureDevices(kernel)[0].inputs[0].state, "no signal");
}

TEST_F(V4l2Test, TheChoiceIsWhatTheSourceThenTakes) {
  plug({.multiplanar = true, .formats = {V4L2_PIX_FMT_YUV420M, V4L2_PIX_FMT_NV12M}});
  V4l2Settings settings{.device = "name:HDMI"};
  const CaptureChoice choice = chooseCapture(kernel, settings);
  EXPECT_EQ(choice.path, "/dev/video0");
  EXPECT_EQ(choice.input, "HDMI");
  EXPECT_EQ(choice.format, "NM12 64x48");
  EXPECT_EQ(choice.reason, "");
  EXPECT_FALSE(card->streaming()) << "looking changes nothing";
  open(settings);
  EXPECT_EQ(card->fourcc(), V4L2_PIX_FMT_NV12M);
}

TEST_F(V4l2Test, WithoutACardTheReasonIsSaid) {
  EXPECT_TRUE(listCaptureDevices(kernel).empty());
  EXPECT_EQ(chooseCapture(kernel, {.device = "auto"}).reason, "no capture device found");
}

}  // namespace
}  // namespace depthscope::capture
