// The card's answers to ioctl(2) that are not about buffers, in the order of the V4L2
// documentation.
#include <linux/v4l2-controls.h>

#include <cstring>

#include "tests/fake_kernel/fake_v4l2_session.hpp"

namespace depthscope::fake {
namespace {

template <std::size_t size>
void put(__u8 (&field)[size], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), size - 1));
}

}  // namespace

int FakeV4l2Card::answer(Session& s, unsigned long request, void* a) {
  switch (request) {
    case VIDIOC_QUERYCAP:
      return queryCap(*static_cast<v4l2_capability*>(a));
    case VIDIOC_ENUMINPUT:
      return enumInput(*static_cast<v4l2_input*>(a));
    case VIDIOC_G_INPUT:
      return *static_cast<int*>(a) = input_, 0;
    case VIDIOC_S_INPUT:
      return setInput(*static_cast<int*>(a));
    case VIDIOC_ENUM_FMT:
      return enumFormat(*static_cast<v4l2_fmtdesc*>(a));
    case VIDIOC_ENUM_FRAMESIZES:
      return enumSizes(*static_cast<v4l2_frmsizeenum*>(a));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return enumIntervals(*static_cast<v4l2_frmivalenum*>(a));
    case VIDIOC_G_FMT:
      return format(*static_cast<v4l2_format*>(a), false, false);
    case VIDIOC_TRY_FMT:
      return format(*static_cast<v4l2_format*>(a), false, true);
    case VIDIOC_S_FMT:
      return format(*static_cast<v4l2_format*>(a), true, true);
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return frameRate(*static_cast<v4l2_streamparm*>(a));
    case VIDIOC_QUERY_DV_TIMINGS:
      return queryTimings(*static_cast<v4l2_dv_timings*>(a));
    case VIDIOC_S_DV_TIMINGS:
      return setTimings(*static_cast<v4l2_dv_timings*>(a));
    case VIDIOC_G_EXT_CTRLS:
      return control(*static_cast<v4l2_ext_controls*>(a));
    case VIDIOC_G_EDID:
      return readEdid(*static_cast<v4l2_edid*>(a));
    case VIDIOC_S_EDID:
      return writeEdid(*static_cast<v4l2_edid*>(a));
    case VIDIOC_SUBSCRIBE_EVENT:
      return subscribe(s, *static_cast<v4l2_event_subscription*>(a));
    case VIDIOC_DQEVENT:
      return nextEventOf(s, *static_cast<v4l2_event*>(a));
    case VIDIOC_REQBUFS:
      return requestBuffers(s, *static_cast<v4l2_requestbuffers*>(a));
    case VIDIOC_QUERYBUF:
      return queryBuffer(*static_cast<v4l2_buffer*>(a));
    case VIDIOC_EXPBUF:
      return exportBuffer(*static_cast<v4l2_exportbuffer*>(a));
    case VIDIOC_QBUF:
      return queueBuffer(s, *static_cast<v4l2_buffer*>(a));
    case VIDIOC_DQBUF:
      return dequeueBuffer(s, *static_cast<v4l2_buffer*>(a));
    case VIDIOC_STREAMON:
      return stream(s, true);
    case VIDIOC_STREAMOFF:
      return stream(s, false);
    default:
      return -ENOTTY;
  }
}

int FakeV4l2Card::queryCap(v4l2_capability& out) const {
  out = {};
  put(out.driver, "fake");
  put(out.card, options_.name);
  put(out.bus_info, options_.bus);
  out.device_caps = V4L2_CAP_STREAMING |
                    (options_.multiplanar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE);
  out.capabilities = out.device_caps | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

int FakeV4l2Card::enumInput(v4l2_input& out) const {
  const __u32 index = out.index;
  if (index >= options_.inputs.size()) return -EINVAL;
  out = {};
  out.index = index;
  put(out.name, options_.inputs[index]);
  out.type = V4L2_INPUT_TYPE_CAMERA;
  out.capabilities = options_.digital ? V4L2_IN_CAP_DV_TIMINGS : 0;
  if (static_cast<int>(index) != input_) return 0;
  if (signal_ == Signal::NoCable || signal_ == Signal::Missing) out.status = V4L2_IN_ST_NO_SIGNAL;
  if (signal_ == Signal::Unlocked || signal_ == Signal::OutOfRange)
    out.status = V4L2_IN_ST_NO_H_LOCK;
  return 0;
}

int FakeV4l2Card::setInput(int index) {
  if (index < 0 || index >= static_cast<int>(options_.inputs.size())) return -EINVAL;
  if (!buffers_.empty() && index != input_) return -EBUSY;
  input_ = index;
  return 0;
}

int FakeV4l2Card::enumFormat(v4l2_fmtdesc& out) const {
  const __u32 index = out.index, type = out.type;
  if (index >= options_.formats.size()) return -EINVAL;
  out = {};
  out.index = index;
  out.type = type;
  out.pixelformat = options_.formats[index];
  put(out.description, "some format");
  return 0;
}

int FakeV4l2Card::enumSizes(v4l2_frmsizeenum& out) const {
  if (options_.digital) return -ENOTTY;
  if (out.index >= options_.sizes.size()) return -EINVAL;
  out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
  out.discrete = {options_.sizes[out.index].first, options_.sizes[out.index].second};
  return 0;
}

int FakeV4l2Card::enumIntervals(v4l2_frmivalenum& out) const {
  const double fps =
      out.pixel_format == V4L2_PIX_FMT_MJPEG ? options_.compressed_fps : options_.raw_fps;
  if (options_.digital || fps == 0) return -ENOTTY;
  if (out.index > 0) return -EINVAL;
  out.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  out.discrete = {1000, static_cast<__u32>(fps * 1000)};
  return 0;
}

int FakeV4l2Card::format(v4l2_format& f, bool set, bool attempt) {
  const __u32 type =
      options_.multiplanar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (f.type != type) return -EINVAL;
  if (!attempt) return describe(f, layout_), 0;
  if (set && !buffers_.empty()) return -EBUSY;
  __u32 fourcc = options_.multiplanar ? f.fmt.pix_mp.pixelformat : f.fmt.pix.pixelformat;
  __u32 width = options_.multiplanar ? f.fmt.pix_mp.width : f.fmt.pix.width;
  __u32 height = options_.multiplanar ? f.fmt.pix_mp.height : f.fmt.pix.height;
  const auto& known = options_.formats;
  if (std::find(known.begin(), known.end(), fourcc) == known.end()) fourcc = known.front();
  if (options_.digital) {
    width = set_mode_.bt.width;
    height = set_mode_.bt.height / (options_.field == V4L2_FIELD_ALTERNATE ? 2 : 1);
  } else if (!options_.sizes.empty()) {
    const auto near = std::min_element(
        options_.sizes.begin(), options_.sizes.end(), [&](const auto& a, const auto& b) {
          const auto off = [&](const auto& s) {
            return std::abs(static_cast<int>(s.first) - static_cast<int>(width));
          };
          return off(a) < off(b);
        });
    width = near->first;
    height = near->second;
  }
  const FakeLayout layout = fakeLayout(fourcc, width, height, options_.padding);
  if (set) layout_ = layout;
  return describe(f, layout), 0;
}

void FakeV4l2Card::describe(v4l2_format& f, const FakeLayout& l) const {
  f.fmt = {};
  const auto common = [&](auto& p) {
    p.width = l.width;
    p.height = l.height;
    p.pixelformat = l.fourcc;
    p.field = options_.field;
    p.colorspace = options_.colorspace;
    p.ycbcr_enc = static_cast<std::remove_reference_t<decltype(p.ycbcr_enc)>>(options_.ycbcr_enc);
    p.quantization =
        static_cast<std::remove_reference_t<decltype(p.quantization)>>(options_.quantization);
  };
  if (options_.multiplanar) {
    v4l2_pix_format_mplane& p = f.fmt.pix_mp;
    common(p);
    p.num_planes = static_cast<__u8>(l.pieces);
    for (std::size_t i = 0; i < l.pieces; ++i) {
      p.plane_fmt[i].bytesperline = static_cast<__u32>(l.stride[i]);
      p.plane_fmt[i].sizeimage = static_cast<__u32>(l.size[i] + options_.data_offset);
    }
  } else {
    common(f.fmt.pix);
    f.fmt.pix.priv = V4L2_PIX_FMT_PRIV_MAGIC;
    f.fmt.pix.bytesperline = static_cast<__u32>(l.stride[0]);
    f.fmt.pix.sizeimage = static_cast<__u32>(l.size[0]);
  }
}

int FakeV4l2Card::frameRate(v4l2_streamparm& p) const {
  if (options_.digital) return -ENOTTY;
  p.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  p.parm.capture.timeperframe = {1000, static_cast<__u32>(options_.camera_fps * 1000)};
  return 0;
}

int FakeV4l2Card::queryTimings(v4l2_dv_timings& out) const {
  if (!options_.digital) return -ENOTTY;
  switch (signal_) {
    case Signal::NoCable:
    case Signal::Missing:
      return -ENOLINK;
    case Signal::Unlocked:
      return -ENOLCK;
    case Signal::OutOfRange:
      return -ERANGE;
    case Signal::Good:
      break;
  }
  out = mode_;
  return 0;
}

int FakeV4l2Card::setTimings(const v4l2_dv_timings& timings) {
  if (!options_.digital) return -ENOTTY;
  if (std::memcmp(&timings, &set_mode_, sizeof timings) == 0) return 0;
  if (!buffers_.empty()) return -EBUSY;
  set_mode_ = timings;
  return 0;
}

int FakeV4l2Card::control(v4l2_ext_controls& controls) const {
  if (!options_.digital || controls.count != 1 ||
      controls.controls->id != V4L2_CID_DV_RX_POWER_PRESENT)
    return -EINVAL;
  controls.controls->value = signal_ == Signal::NoCable ? 0 : 1;
  return 0;
}

int FakeV4l2Card::readEdid(v4l2_edid& e) const {
  if (!options_.digital) return -ENOTTY;
  if (e.pad >= options_.inputs.size()) return -EINVAL;
  if (edid_.empty()) return -ENODATA;
  const auto there = static_cast<__u32>(edid_.size() / 128);
  if (e.start_block >= there) return -EINVAL;
  e.blocks = std::min(e.blocks, there - e.start_block);
  std::memcpy(e.edid, edid_.data() + 128 * e.start_block, 128 * e.blocks);
  return 0;
}

int FakeV4l2Card::writeEdid(v4l2_edid& e) {
  if (!options_.digital) return -ENOTTY;
  if (e.pad >= options_.inputs.size() || e.start_block != 0) return -EINVAL;
  if (e.blocks > 2) return e.blocks = 2, -E2BIG;
  if (!buffers_.empty()) return -EBUSY;
  edid_.assign(e.edid, e.edid + 128 * e.blocks);
  ++edid_writes_;
  return 0;
}

int FakeV4l2Card::subscribe(Session& session, const v4l2_event_subscription& s) {
  if (!options_.events || s.type != V4L2_EVENT_SOURCE_CHANGE) return -EINVAL;
  session.subscribed = true;
  return 0;
}

int FakeV4l2Card::nextEventOf(Session& session, v4l2_event& out) {
  if (session.events.empty()) return -ENOENT;
  out = session.events.front();
  session.events.pop_front();
  out.pending = static_cast<__u32>(session.events.size());
  return 0;
}

}  // namespace depthscope::fake
