#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "capture/frame.hpp"

namespace depthscope::capture {

/// Decodes the JPEG pictures of a camera (MJPG) with libjpeg-turbo, to their own YUV samples
/// without any conversion. Once warm it does not allocate for baseline JPEG, which is what cameras
/// send. From one thread.
class JpegDecoder {
 public:
  JpegDecoder();
  ~JpegDecoder();
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  /// The format of the picture in `jpeg`, which stays where it is until decode(): Yuv420p, Yuv422p,
  /// Yuv444p or Gray8 with full range and BT.601, as JFIF has it. False: not a JPEG, damaged, or of
  /// another kind (colours that are not YUV, other sampling, larger than FramePool takes).
  bool readHeader(std::span<const std::uint8_t> jpeg, FrameFormat& format);
  /// Decodes it into a frame of that format from a FramePool. False when the data are damaged,
  /// broken off, or unreadable; what is in the frame then is no picture.
  bool decode(Frame& frame);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace depthscope::capture
