#include <algorithm>
#include <vector>

#include "capture/v4l2_devices.hpp"
#include "capture/v4l2_format.hpp"

namespace depthscope::capture {
namespace {

constexpr double kMovingPicture = 24;  // [1/s] below it, compressed is better than jerky
constexpr int kMostEntries = 256;      // of a driver's list, should it have no end

template <typename Pixels>
void fill(Pixels& pixels, __u32 fourcc, int width, int height) {
  pixels.width = static_cast<__u32>(width);
  pixels.height = static_cast<__u32>(height);
  pixels.pixelformat = fourcc;
  pixels.field = V4L2_FIELD_NONE;
}

/// Lines and images of 0 bytes: the driver works them out.
v4l2_format formatRequest(const V4l2Node& node, __u32 fourcc, int width, int height) {
  v4l2_format format{};
  format.type = node.bufferType();
  if (node.multiplanar())
    fill(format.fmt.pix_mp, fourcc, width, height);
  else
    fill(format.fmt.pix, fourcc, width, height);
  return format;
}

/// Highest rate [1/s] that the driver names for a format and size; 0 when it names none.
double highestRate(const V4l2Node& node, __u32 fourcc, int width, int height) {
  double best = 0;
  for (__u32 i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum interval{};
    interval.index = i;
    interval.pixel_format = fourcc;
    interval.width = static_cast<__u32>(width);
    interval.height = static_cast<__u32>(height);
    if (node.ask(VIDIOC_ENUM_FRAMEINTERVALS, interval) < 0) break;
    const v4l2_fract& t =
        interval.type == V4L2_FRMIVAL_TYPE_DISCRETE ? interval.discrete : interval.stepwise.min;
    if (t.numerator > 0) best = std::max(best, double(t.denominator) / t.numerator);
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) break;
  }
  return best;
}

struct Candidate {
  __u32 fourcc = 0;
  bool right_size = false, fast = false;
};

/// Better ones first; what is equal stays in the order of preference.
bool better(const Candidate& a, const Candidate& b) {
  if (a.right_size != b.right_size) return a.right_size;
  return a.fast && !b.fast;
}

}  // namespace

std::vector<v4l2_fmtdesc> offeredFormats(const V4l2Node& node) {
  std::vector<v4l2_fmtdesc> offered;
  for (__u32 i = 0; i < kMostEntries; ++i) {
    v4l2_fmtdesc format{};
    format.index = i;
    format.type = node.bufferType();
    if (node.ask(VIDIOC_ENUM_FMT, format) < 0) break;
    offered.push_back(format);
  }
  return offered;
}

namespace {

/// What the card and we have in common, tried for a size.
std::vector<Candidate> candidates(const V4l2Node& node, const V4l2Settings& wanted,
                                  const std::vector<v4l2_fmtdesc>& offered, int width, int height) {
  std::vector<Candidate> found;
  const double enough = wanted.fps > 0 ? 0.9 * wanted.fps : kMovingPicture;
  for (const __u32 fourcc : preferredFormats()) {
    const bool there = std::any_of(offered.begin(), offered.end(),
                                   [&](const auto& f) { return f.pixelformat == fourcc; });
    if (!there || (wanted.pixel_format != "auto" && fourccText(fourcc) != wanted.pixel_format))
      continue;
    v4l2_format attempt = formatRequest(node, fourcc, width, height);
    if (node.ask(VIDIOC_TRY_FMT, attempt) < 0) continue;
    const auto tried = layoutOf(attempt);
    if (!tried) continue;
    const double rate = highestRate(node, fourcc, tried->format.width, tried->format.height);
    found.push_back({fourcc, tried->format.width == width, rate == 0 || rate >= enough});
  }
  std::stable_sort(found.begin(), found.end(), better);
  return found;
}

std::string nothingInCommon(const V4l2Settings& wanted, const std::vector<v4l2_fmtdesc>& offered) {
  std::string text = "no pixel format in common: the card offers";
  for (const v4l2_fmtdesc& format : offered)
    text.append(" ").append(fourccText(format.pixelformat));
  if (offered.empty()) text.append(" none");
  return text.append(", wanted is ").append(wanted.pixel_format);
}

}  // namespace

int chooseFormat(const V4l2Node& node, const V4l2Settings& wanted, int width, int height,
                 v4l2_format& format, std::string& detail) {
  format = {};
  format.type = node.bufferType();
  if (const int error = node.ask(VIDIOC_G_FMT, format); error < 0) {
    detail = "G_FMT: " + errorText(error);
    return error;
  }
  if (width == 0 || height == 0) {
    const bool multi = node.multiplanar();
    width = static_cast<int>(multi ? format.fmt.pix_mp.width : format.fmt.pix.width);
    height = static_cast<int>(multi ? format.fmt.pix_mp.height : format.fmt.pix.height);
  }
  const std::vector<v4l2_fmtdesc> offered = offeredFormats(node);
  const std::vector<Candidate> found = candidates(node, wanted, offered, width, height);
  if (found.empty()) {
    detail = nothingInCommon(wanted, offered);
    return -EINVAL;
  }
  format = formatRequest(node, found.front().fourcc, width, height);
  return 0;
}

int setBestFormat(const V4l2Node& node, const V4l2Settings& wanted, int width, int height,
                  V4l2Layout& layout, std::string& detail) {
  v4l2_format format;
  if (const int error = chooseFormat(node, wanted, width, height, format, detail); error < 0)
    return error;
  if (const int error = node.ask(VIDIOC_S_FMT, format); error < 0) {
    detail = "S_FMT: " + errorText(error);
    return error;
  }
  const auto result = layoutOf(format);
  if (!result) {
    detail = "the card set a format that cannot be read";
    return -EINVAL;
  }
  layout = *result;
  return 0;
}

double setFrameRate(const V4l2Node& node, const V4l2Layout& layout, double wanted) {
  if (wanted == 0)
    wanted = highestRate(node, layout.fourcc, layout.format.width, layout.format.height);
  v4l2_streamparm parameters{};
  parameters.type = node.bufferType();
  if (node.ask(VIDIOC_G_PARM, parameters) < 0) return 0;
  v4l2_captureparm& capture = parameters.parm.capture;
  if (capture.capability & V4L2_CAP_TIMEPERFRAME && wanted > 0) {
    capture.timeperframe = {1000, static_cast<__u32>(wanted * 1000 + 0.5)};
    node.ask(VIDIOC_S_PARM, parameters);
  }
  const v4l2_fract& period = capture.timeperframe;
  return period.numerator > 0 ? double(period.denominator) / period.numerator : 0;
}

}  // namespace depthscope::capture
