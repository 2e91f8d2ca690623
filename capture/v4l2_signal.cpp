#include "capture/v4l2_signal.hpp"

#include <linux/v4l2-controls.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "capture/v4l2_devices.hpp"

namespace depthscope::capture {
namespace {

constexpr __u32 kNoSignal = V4L2_IN_ST_NO_POWER | V4L2_IN_ST_NO_SIGNAL | V4L2_IN_ST_NO_CARRIER;
constexpr __u32 kNoLock = V4L2_IN_ST_NO_H_LOCK | V4L2_IN_ST_NO_V_LOCK | V4L2_IN_ST_NO_STD_LOCK |
                          V4L2_IN_ST_NO_SYNC | V4L2_IN_ST_NO_EQU;
constexpr __u32 kMostInputs = 64;

V4l2Input inputOf(const v4l2_input& from) {
  const char* name = reinterpret_cast<const char*>(from.name);
  return {true,
          static_cast<int>(from.index),
          {name, ::strnlen(name, sizeof from.name)},
          from.status,
          (from.capabilities & V4L2_IN_CAP_DV_TIMINGS) != 0,
          (from.capabilities & V4L2_IN_CAP_STD) != 0};
}

int currentInput(const V4l2Node& node, V4l2Input& input) {
  int index = 0;
  if (const int error = node.ask(VIDIOC_G_INPUT, index); error < 0) return error;
  v4l2_input info{};
  info.index = static_cast<__u32>(index);
  if (const int error = node.ask(VIDIOC_ENUMINPUT, info); error < 0) return error;
  input = inputOf(info);
  return 0;
}

/// Whether no HDMI input gets 5 V from a source. The control has a bit for each of them.
bool isUnplugged(const V4l2Node& node) {
  v4l2_ext_control control{};
  control.id = V4L2_CID_DV_RX_POWER_PRESENT;
  v4l2_ext_controls controls{};
  controls.which = V4L2_CTRL_WHICH_CUR_VAL;
  controls.count = 1;
  controls.controls = &control;
  return node.ask(VIDIOC_G_EXT_CTRLS, controls) == 0 && control.value == 0;
}

SignalState noSignal(const V4l2Node& node, std::string detail) {
  if (isUnplugged(node)) return {SourceStatus::NoCable, detail + ", no 5 V from the source"};
  return {SourceStatus::NoSignal, std::move(detail)};
}

SignalState fromInputStatus(const V4l2Node& node, __u32 status) {
  const std::string detail = "the input says: " + inputStateText(status);
  if (status & kNoSignal) return noSignal(node, detail);
  if (status & kNoLock) return {SourceStatus::UnstableSync, detail};
  return {};
}

SignalState deviceError(const char* call, int error) {
  const bool gone = error == -ENODEV || error == -ENXIO;
  return {gone ? SourceStatus::NoDevice : SourceStatus::ReadError,
          std::string(call) + ": " + errorText(error)};
}

}  // namespace

std::vector<V4l2Input> listInputs(const V4l2Node& node) {
  std::vector<V4l2Input> inputs;
  for (__u32 i = 0; i < kMostInputs; ++i) {
    v4l2_input info{};
    info.index = i;
    if (node.ask(VIDIOC_ENUMINPUT, info) < 0) break;
    inputs.push_back(inputOf(info));
  }
  return inputs;
}

int selectInput(const V4l2Node& node, const std::string& wanted, V4l2Input& input,
                std::string& detail) {
  input = {};
  const int error = currentInput(node, input);
  if (error < 0 && error != -ENOTTY) {
    detail = "G_INPUT: " + errorText(error);
    return error;
  }
  if (wanted.empty() || input.name == wanted || std::to_string(input.index) == wanted) return 0;
  const std::vector<V4l2Input> inputs = listInputs(node);
  auto found = std::find_if(inputs.begin(), inputs.end(),
                            [&](const V4l2Input& i) { return i.name == wanted; });
  if (found == inputs.end())
    found = std::find_if(inputs.begin(), inputs.end(),
                         [&](const V4l2Input& i) { return std::to_string(i.index) == wanted; });
  if (found == inputs.end()) {
    detail = "no input \"" + wanted + "\" among";
    for (const V4l2Input& i : inputs) detail += " \"" + i.name + "\"";
    return -EINVAL;
  }
  int index = found->index;
  if (const int failed = node.ask(VIDIOC_S_INPUT, index); failed < 0) {
    detail = "S_INPUT " + wanted + ": " + errorText(failed);
    return failed;
  }
  input = *found;
  return 0;
}

SignalState querySignal(const V4l2Node& node, const V4l2Input& input) {
  if (!input.known) return {};
  v4l2_input info{};
  info.index = static_cast<__u32>(input.index);
  if (const int error = node.ask(VIDIOC_ENUMINPUT, info); error < 0)
    return deviceError("ENUMINPUT", error);
  if (!input.has_timings) return fromInputStatus(node, info.status);
  SignalState state;
  const int error = node.ask(VIDIOC_QUERY_DV_TIMINGS, state.timings);
  switch (error) {
    case -ENOLINK:
      return noSignal(node, "the input finds no signal");
    case -ENOLCK:
      return {SourceStatus::UnstableSync, "the input cannot lock to the signal"};
    case -ERANGE:
      return {SourceStatus::UnsupportedMode, "the signal is out of the card's range"};
    case -ENOTTY:
    case -ENODATA:  // a card that cannot measure: what the input says has to do
      return fromInputStatus(node, info.status);
    default:
      break;
  }
  if (error < 0) return deviceError("QUERY_DV_TIMINGS", error);
  if (info.status & (kNoSignal | kNoLock)) return fromInputStatus(node, info.status);
  state.has_timings = state.timings.type == V4L2_DV_BT_656_1120;
  return state;
}

int adoptTimings(const V4l2Node& node, const V4l2Input& input, const SignalState& signal) {
  if (signal.has_timings) {
    v4l2_dv_timings timings = signal.timings;
    return node.ask(VIDIOC_S_DV_TIMINGS, timings);
  }
  v4l2_std_id standard = 0;
  if (!input.has_standard || node.ask(VIDIOC_QUERYSTD, standard) < 0 || standard == 0) return 0;
  return node.ask(VIDIOC_S_STD, standard);
}

bool sameMode(const v4l2_dv_timings& a, const v4l2_dv_timings& b) {
  const double clock_a = static_cast<double>(a.bt.pixelclock);
  const double clock_b = static_cast<double>(b.bt.pixelclock);
  return a.bt.width == b.bt.width && a.bt.height == b.bt.height &&
         a.bt.interlaced == b.bt.interlaced &&
         std::abs(clock_a - clock_b) <= 0.005 * std::max(clock_a, clock_b);
}

double frameRate(const v4l2_dv_timings& timings) {
  const v4l2_bt_timings& bt = timings.bt;
  const double total = static_cast<double>(V4L2_DV_BT_FRAME_WIDTH(&bt)) *
                       static_cast<double>(V4L2_DV_BT_FRAME_HEIGHT(&bt));
  return total > 0 ? static_cast<double>(bt.pixelclock) / total : 0;
}

std::string modeText(const v4l2_dv_timings& timings) {
  char text[64];
  std::snprintf(text, sizeof text, "%ux%u at %.2f%s", timings.bt.width, timings.bt.height,
                frameRate(timings), timings.bt.interlaced ? ", interlaced" : "");
  return text;
}

std::string inputStateText(__u32 status) {
  struct Flag {
    __u32 bit;
    const char* text;
  };
  constexpr Flag kFlags[] = {{V4L2_IN_ST_NO_POWER, "no power"},
                             {V4L2_IN_ST_NO_SIGNAL, "no signal"},
                             {V4L2_IN_ST_NO_CARRIER, "no carrier"},
                             {V4L2_IN_ST_NO_H_LOCK, "no horizontal lock"},
                             {V4L2_IN_ST_NO_V_LOCK, "no vertical lock"},
                             {V4L2_IN_ST_NO_STD_LOCK, "no standard lock"},
                             {V4L2_IN_ST_NO_SYNC, "no sync"},
                             {V4L2_IN_ST_NO_EQU, "no equalizer lock"}};
  std::string text;
  for (const Flag& flag : kFlags)
    if (status & flag.bit) text += (text.empty() ? "" : ", ") + std::string(flag.text);
  return text.empty() ? "ok" : text;
}

}  // namespace depthscope::capture
