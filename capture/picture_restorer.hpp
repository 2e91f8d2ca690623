#pragma once
#include <memory>

#include "capture/frame.hpp"
#include "capture/jpeg_decoder.hpp"
#include "capture/v4l2_format.hpp"

namespace depthscope::capture {

/// Turns what a card delivers into whole progressive pictures: hands plain ones on as they are,
/// makes frames of interlaced ones, decodes JPEG. Buffers are had at the first picture of a format.
class PictureRestorer {
 public:
  /// Whether pictures of this layout can be restored; else why not.
  static const char* refusal(const V4l2Layout& layout);

  void reset(const V4l2Layout& layout, int buffers);
  /// Format of what restore() gives, as far as it is known before the first picture.
  FrameFormat format() const;
  /// `taken` is a picture in the layout's format; `bytes` of it are filled, and `field` is what the
  /// driver said of this one. Empty: it is damaged, or (none lent out is free) to be skipped.
  Frame restore(Frame taken, std::size_t bytes, __u32 field, bool& damaged);

 private:
  Frame deinterlaced(const Frame& taken, __u32 field);
  Frame decoded(const Frame& taken, std::size_t bytes, bool& damaged);
  Frame acquire(const FrameFormat& format);

  V4l2Layout layout_;
  int buffers_ = 0;
  std::shared_ptr<FramePool> pool_;
  JpegDecoder jpeg_;
};

}  // namespace depthscope::capture
