// Captures colour bars of the kernel's virtual card (vivid) in every pixel format it has and at
// several modes, through the source that the daemon uses, and compares them with what bars are.
//   hil_capture_check DEVICE [PICTURES]
// One line for each mode and format; exit status 0 when all are right, 1 when not, 2 without a
// card.
#include <linux/v4l2-dv-timings.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "capture/pixel_convert.hpp"
#include "capture/v4l2_devices.hpp"
#include "capture/v4l2_format.hpp"
#include "capture/v4l2_source.hpp"

namespace depthscope::capture {
namespace {

using namespace std::chrono_literals;

constexpr int kBars[8][3] = {{255, 255, 255}, {255, 255, 0}, {0, 255, 255}, {0, 255, 0},
                             {255, 0, 255},   {255, 0, 0},   {0, 0, 255},   {0, 0, 0}};
constexpr int kTolerance = 4;    // [levels] 8-bit YUV of saturated colours and back
constexpr auto kPatience = 30s;  // for a picture: the machine may be an emulated one
constexpr double kLowest = 0.6, kHighest = 0.9;  // of the height: below the text in the picture

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
constexpr v4l2_dv_timings kModes[] = {V4L2_DV_BT_CEA_640X480P59_94, V4L2_DV_BT_CEA_1280X720P60,
                                      V4L2_DV_BT_CEA_1920X1080P60};
#pragma GCC diagnostic pop

/// Sets a control by its name, where the card has it.
bool setControl(const V4l2Node& node, const char* name, int value) {
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (node.ask(VIDIOC_QUERYCTRL, query) == 0) {
    if (std::strcmp(reinterpret_cast<const char*>(query.name), name) == 0) {
      v4l2_control control{query.id, value};
      return node.ask(VIDIOC_S_CTRL, control) == 0;
    }
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return false;
}

/// Largest difference to the bars, in levels, over the middle half of each bar; a grey format shows
/// their BT.709 luma, whatever the mode.
int worstLevel(const Frame& frame) {
  const int width = frame.format.width, height = frame.format.height;
  std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width) *
                                 static_cast<std::size_t>(height) * 4);
  toRgba(frame, rgba);
  const bool gray = frame.format.pixel_format == PixelFormat::Gray8;
  int worst = 0;
  for (int y = static_cast<int>(kLowest * height); y < kHighest * height; ++y)
    for (int bar = 0; bar < 8; ++bar)
      for (int x = width * (4 * bar + 1) / 32; x < width * (4 * bar + 3) / 32; ++x)
        for (int c = 0; c < 3; ++c) {
          const int* b = kBars[bar];
          const double luma = 0.2126 * b[0] + 0.7152 * b[1] + 0.0722 * b[2];
          const int expected = gray ? static_cast<int>(luma + 0.5) : b[c];
          const auto at = static_cast<std::size_t>(4 * (y * width + x) + c);
          worst = std::max(worst, std::abs(rgba[at] - expected));
        }
  return worst;
}

/// One format at one mode; false when a picture is wrong or does not come.
bool check(const char* device, const std::string& fourcc, const v4l2_bt_timings* mode,
           int pictures) {
  V4l2Settings settings;
  settings.device = device;
  settings.edid = "none";
  settings.pixel_format = fourcc;
  kernel::SystemCalls& calls = kernel::realSystemCalls();
  V4l2Source source(settings, calls);
  const auto end = calls.now() + kPatience;
  int seen = 0, worst = 0;
  bool exported = false, right_size = true;
  FrameFormat format;
  while (seen < pictures && calls.now() < end) {
    const ReadResult result = source.read(1s);
    if (result.status != SourceStatus::Ok) continue;
    ++seen;
    format = result.frame.format;
    exported = result.frame.dma[0].fd >= 0;
    worst = std::max(worst, worstLevel(result.frame));
    if (mode)
      right_size = right_size && format.width == static_cast<int>(mode->width) &&
                   format.height == static_cast<int>(mode->height);
  }
  const bool ok = seen == pictures && worst <= kTolerance && right_size;
  std::printf(
      "%s %dx%d %s: %d pictures, off by %d levels at most%s%s%s%.*s\n", ok ? "ok  " : "FAIL",
      format.width, format.height, fourcc.c_str(), seen, worst, exported ? ", DMABUF" : "",
      right_size ? "" : ", wrong size", seen < pictures ? ", " : "",
      seen < pictures ? static_cast<int>(source.detail().size()) : 0, source.detail().data());
  std::fflush(stdout);
  return ok;
}

int run(const char* device, int pictures) {
  V4l2Node node;
  if (const int error = V4l2Node::open(kernel::realSystemCalls(), device, node); error < 0) {
    std::fprintf(stderr, "%s: %s\n", device, errorText(error).c_str());
    return 2;
  }
  setControl(node, "OSD Text Mode", 2);
  if (!setControl(node, "Test Pattern", 1)) {
    std::fprintf(stderr, "%s: has no test pattern, expected vivid\n", device);
    return 2;
  }
  bool right = true;
  for (const v4l2_dv_timings& mode : kModes) {
    v4l2_dv_timings wanted = mode;
    const int error = node.ask(VIDIOC_S_DV_TIMINGS, wanted);
    const bool has_modes = error != -ENOTTY && error != -ENODATA;
    if (has_modes && error < 0) {
      std::printf("FAIL %ux%u: %s\n", mode.bt.width, mode.bt.height, errorText(error).c_str());
      right = false;
      continue;
    }
    for (const v4l2_fmtdesc& format : offeredFormats(node)) {
      const auto ours = preferredFormats();
      if (std::find(ours.begin(), ours.end(), format.pixelformat) != ours.end())
        right &=
            check(device, fourccText(format.pixelformat), has_modes ? &mode.bt : nullptr, pictures);
    }
    if (!has_modes) break;
  }
  return right ? 0 : 1;
}

}  // namespace
}  // namespace depthscope::capture

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("hil_capture_check DEVICE [PICTURES]\n", stderr);
    return 2;
  }
  return depthscope::capture::run(argv[1], argc > 2 ? std::atoi(argv[2]) : 2);
}
