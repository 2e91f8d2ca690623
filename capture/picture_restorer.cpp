#include "capture/picture_restorer.hpp"

#include <exception>

#include "capture/deinterlace.hpp"

namespace depthscope::capture {
namespace {

/// Fields come one by one, each as a picture of half the height.
bool comesInFields(__u32 field) {
  return field == V4L2_FIELD_ALTERNATE || field == V4L2_FIELD_TOP || field == V4L2_FIELD_BOTTOM;
}

/// The newer field of a picture, and where it is. "Interlaced" leaves the order to the standard:
/// NTSC, of 480 lines, sends the bottom field first, everything else the top one.
FieldLines newerField(__u32 layout, __u32 picture, int height) {
  using Place = FieldLines::Place;
  switch (layout) {
    case V4L2_FIELD_INTERLACED_TB:
      return {false, Place::Woven};
    case V4L2_FIELD_INTERLACED_BT:
      return {true, Place::Woven};
    case V4L2_FIELD_INTERLACED:
      return {height <= 486, Place::Woven};
    case V4L2_FIELD_SEQ_TB:
      return {false, Place::SecondHalf};
    case V4L2_FIELD_SEQ_BT:
      return {true, Place::SecondHalf};
    case V4L2_FIELD_BOTTOM:
      return {false, Place::Alone};
    case V4L2_FIELD_ALTERNATE:
      return {picture != V4L2_FIELD_BOTTOM, Place::Alone};
    default:
      return {true, Place::Alone};
  }
}

bool isProgressive(__u32 field) {
  return field == V4L2_FIELD_NONE || field == V4L2_FIELD_ANY;
}

}  // namespace

const char* PictureRestorer::refusal(const V4l2Layout& layout) {
  const bool deinterlaces = comesInFields(layout.field) || layout.field == V4L2_FIELD_INTERLACED ||
                            layout.field == V4L2_FIELD_INTERLACED_TB ||
                            layout.field == V4L2_FIELD_INTERLACED_BT ||
                            layout.field == V4L2_FIELD_SEQ_TB || layout.field == V4L2_FIELD_SEQ_BT;
  if (!isProgressive(layout.field) && !deinterlaces) return "an unknown order of fields";
  if (!isProgressive(layout.field) && layout.jpeg) return "interlaced and compressed";
  return nullptr;
}

void PictureRestorer::reset(const V4l2Layout& layout, int buffers) {
  layout_ = layout;
  buffers_ = buffers;
  if (!layout.jpeg && isProgressive(layout.field)) pool_ = nullptr;
}

FrameFormat PictureRestorer::format() const {
  FrameFormat format = layout_.format;
  if (comesInFields(layout_.field)) format.height *= 2;
  return format;
}

Frame PictureRestorer::restore(Frame taken, std::size_t bytes, __u32 field, bool& damaged) {
  damaged = false;
  if (isProgressive(layout_.field) && !layout_.jpeg) return taken;
  Frame whole = layout_.jpeg ? decoded(taken, bytes, damaged) : deinterlaced(taken, field);
  whole.sequence = taken.sequence;
  whole.capture_time = taken.capture_time;
  whole.media_time_s = taken.media_time_s;
  return whole;
}

/// Empty too when memory cannot be had for a new format.
Frame PictureRestorer::acquire(const FrameFormat& format) {
  if (!pool_ || pool_->format() != format) {
    pool_ = nullptr;
    try {
      pool_ = FramePool::create(format, buffers_);
    } catch (const std::exception&) {
      return {};
    }
  }
  return pool_->acquire();
}

Frame PictureRestorer::deinterlaced(const Frame& taken, __u32 field) {
  Frame whole = acquire(format());
  if (!whole.empty())
    deinterlace(taken, newerField(layout_.field, field, whole.format.height), whole);
  return whole;
}

Frame PictureRestorer::decoded(const Frame& taken, std::size_t bytes, bool& damaged) {
  const std::span<const std::uint8_t> jpeg(taken.planes[0].data, bytes);
  FrameFormat format;
  damaged = !jpeg_.readHeader(jpeg, format) || format.width != layout_.format.width ||
            format.height != layout_.format.height;
  if (damaged) return {};
  Frame picture = acquire(format);
  damaged = !picture.empty() && !jpeg_.decode(picture);
  return damaged ? Frame() : std::move(picture);
}

}  // namespace depthscope::capture
