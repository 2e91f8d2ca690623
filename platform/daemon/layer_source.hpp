#pragma once
#include <chrono>
#include <cstdint>
#include <vector>

#include "overlay/overlay_state.hpp"
#include "overlay/pixel_rect.hpp"

namespace depthscope::platform {

/// A picture that an overlay is wanted for.
struct LayerRequest {
  std::uint64_t number = 0;  // grows by one with each request
  int width = 0, height = 0;
  std::int64_t frame = -1;  // the number under which the AR process was given the picture
  bool damaged = false;     // the source flagged the picture
  std::chrono::steady_clock::time_point captured{};
  std::chrono::steady_clock::time_point
      deadline{};  // the picture goes out then, with it or without
};

/// An overlay, ready to be laid over pictures.
struct OverlayLayer {
  std::uint64_t number = 0;  // the request it was drawn for
  int width = 0, height = 0;
  overlay::PixelRect rect;  // outside of it the layer is transparent
  overlay::Status status = overlay::Status::NoAr;
  bool drawn = false;  // false: the graphics driver failed, there is the mark at most
  bool posed = false;  // something in it hangs on a pose: while Tracking, and fading afterwards
  std::chrono::steady_clock::time_point captured{};       // of the picture it was drawn for
  std::chrono::steady_clock::time_point pose_captured{};  // of the picture that its pose was found
                                                          // in; meaningful while posed
  std::vector<std::uint8_t> pixels;  // premultiplied R G B A, width * height * 4 bytes
};

/// Where the video loop gets its overlays from. Used from the video loop's thread.
class LayerSource {
 public:
  virtual ~LayerSource() = default;
  /// Asks for an overlay; a request that nobody has begun with is superseded. Never waits.
  virtual void request(const LayerRequest& request) = 0;
  /// The newest overlay there is, after waiting until `deadline` at most for that of the last
  /// request; null as long as there was none. Valid until the next call.
  virtual const OverlayLayer* newest(std::chrono::steady_clock::time_point deadline) = 0;
};

}  // namespace depthscope::platform
