#include "capture/v4l2_devices.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "capture/v4l2_edid.hpp"
#include "capture/v4l2_format.hpp"
#include "capture/v4l2_signal.hpp"

namespace depthscope::capture {
namespace {

constexpr __u32 kMostEntries = 64;  // of a driver's list, should it have no end

std::string sizeText(__u32 width, __u32 height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::string rateText(const v4l2_fract& period) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g",
                period.numerator > 0 ? double(period.denominator) / period.numerator : 0);
  return text;
}

/// " at 60, 30": the rates for a size, or nothing.
std::string ratesText(const V4l2Node& node, __u32 fourcc, __u32 width, __u32 height) {
  std::string text;
  for (__u32 i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum interval{};
    interval.index = i;
    interval.pixel_format = fourcc;
    interval.width = width;
    interval.height = height;
    if (node.ask(VIDIOC_ENUM_FRAMEINTERVALS, interval) < 0) break;
    text += text.empty() ? " at " : ", ";
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE)
      return text + rateText(interval.stepwise.max) + " to " + rateText(interval.stepwise.min);
    text += rateText(interval.discrete);
  }
  return text;
}

std::vector<std::string> sizesOf(const V4l2Node& node, __u32 fourcc) {
  std::vector<std::string> sizes;
  for (__u32 i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = fourcc;
    if (node.ask(VIDIOC_ENUM_FRAMESIZES, size) < 0) break;
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      const v4l2_frmsize_stepwise& s = size.stepwise;
      sizes.push_back(sizeText(s.min_width, s.min_height) + " to " +
                      sizeText(s.max_width, s.max_height));
      break;
    }
    const auto& [width, height] = size.discrete;
    sizes.push_back(sizeText(width, height) + ratesText(node, fourcc, width, height));
  }
  return sizes;
}

std::vector<CaptureFormat> formatsOf(const V4l2Node& node) {
  std::vector<CaptureFormat> formats;
  const auto usable = preferredFormats();
  for (const v4l2_fmtdesc& f : offeredFormats(node)) {
    const char* text = reinterpret_cast<const char*>(f.description);
    formats.push_back({fourccText(f.pixelformat),
                       {text, ::strnlen(text, sizeof f.description)},
                       std::find(usable.begin(), usable.end(), f.pixelformat) != usable.end(),
                       sizesOf(node, f.pixelformat)});
  }
  return formats;
}

void describeSignal(const V4l2Node& node, CaptureDevice& device) {
  V4l2Input current;
  std::string detail;
  if (selectInput(node, "", current, detail) < 0) return;
  for (const V4l2Input& input : listInputs(node))
    device.inputs.push_back({input.index, input.name, inputStateText(input.status),
                             current.known && input.index == current.index});
  if (!current.has_timings) return;
  const SignalState signal = querySignal(node, current);
  device.signal = signal.status != SourceStatus::Ok ? signal.detail
                  : signal.has_timings              ? modeText(signal.timings)
                                                    : std::string();
  device.has_edid = hasEdid(node, current.index);
}

/// The links under /dev/v4l/FOLDER that lead to `path`.
void addLinks(kernel::SystemCalls& calls, const std::string& folder, CaptureDevice& device) {
  std::vector<std::string> names;
  if (calls.list(folder.c_str(), names) < 0) return;
  const std::string node = device.path.substr(device.path.rfind('/'));
  for (const std::string& name : names) {
    std::string target;
    const std::string link = folder + "/" + name;
    if (calls.readLink(link.c_str(), target) == 0 && target.ends_with(node))
      device.links.push_back(link);
  }
}

}  // namespace

std::vector<CaptureDevice> listCaptureDevices(kernel::SystemCalls& calls) {
  std::vector<CaptureDevice> devices;
  for (const std::string& path : videoNodes(calls)) {
    V4l2Node node;
    const int error = V4l2Node::open(calls, path, node);
    if (error == -ENOTTY) continue;  // an output, metadata, a tuner
    CaptureDevice device;
    device.path = path;
    for (const char* folder : {"/dev/v4l/by-path", "/dev/v4l/by-id"})
      addLinks(calls, folder, device);
    if (error < 0) {
      device.error = errorText(error);
    } else {
      device.driver = node.driver();
      device.card = node.card();
      device.bus = node.bus();
      device.multiplanar = node.multiplanar();
      device.formats = formatsOf(node);
      describeSignal(node, device);
    }
    devices.push_back(std::move(device));
  }
  return devices;
}

CaptureChoice chooseCapture(kernel::SystemCalls& calls, const V4l2Settings& settings) {
  CaptureChoice choice;
  V4l2Node node;
  if (openSelected(calls, settings.device, node, choice.reason) < 0) return choice;
  choice.path = node.path();
  // What is asked about another input than the present one cannot be known without switching.
  V4l2Input input;
  if (selectInput(node, "", input, choice.reason) < 0) return choice;
  if (!settings.input.empty() && settings.input != input.name &&
      settings.input != std::to_string(input.index)) {
    choice.input = settings.input;
    choice.reason = "the input is not the one that is set now";
    return choice;
  }
  choice.input = input.name;
  const SignalState signal = querySignal(node, input);
  const bool timed = signal.has_timings;
  v4l2_format format;
  if (chooseFormat(node, settings, timed ? int(signal.timings.bt.width) : settings.width,
                   timed ? int(signal.timings.bt.height) : settings.height, format,
                   choice.reason) < 0)
    return choice;
  choice.reason = signal.detail;
  choice.format = node.multiplanar()
                      ? fourccText(format.fmt.pix_mp.pixelformat) + " " +
                            sizeText(format.fmt.pix_mp.width, format.fmt.pix_mp.height)
                      : fourccText(format.fmt.pix.pixelformat) + " " +
                            sizeText(format.fmt.pix.width, format.fmt.pix.height);
  return choice;
}

}  // namespace depthscope::capture
