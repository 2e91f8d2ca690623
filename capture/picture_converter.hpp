#pragma once
#include "capture/av_support.hpp"
#include "capture/frame.hpp"

namespace depthscope::capture {

/// Puts decoded pictures into frames of one format: copied row by row where the picture is in that
/// format already, else converted and scaled by libswscale in its bit-exact mode, so that every
/// processor gives the same pixels.
class PictureConverter {
 public:
  /// Fills `frame`'s planes; false when libswscale cannot convert this picture.
  bool convert(const AVFrame& picture, Frame& frame);

 private:
  bool scale(const AVFrame& picture, Frame& frame);

  AvPtr<SwsContext> scaler_;  // made for the picture's format when it is first met
};

}  // namespace depthscope::capture
