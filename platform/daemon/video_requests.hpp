#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "overlay/overlay_settings.hpp"
#include "types/image_view.hpp"

namespace depthscope::platform {

/// What the control socket asks of the video loop and of the overlay. These only ever try the lock:
/// a request that they miss is served with the next picture.
class VideoRequests {
 public:
  /// A picture as it was shown. `frame` is the number of the picture from the scope in it, negative
  /// where that is an old one or none.
  struct Snapshot {
    int width = 0, height = 0;
    std::int64_t frame = -1;
    std::vector<std::uint8_t> pixels;  // R G B A, rows packed
  };

  // From the service's thread.
  void setOverlay(const overlay::OverlaySettings& settings);
  /// Waits for the next picture, for a second at most.
  std::optional<Snapshot> snapshot();

  // From the thread that draws the overlay.
  std::optional<overlay::OverlaySettings> takeOverlay();

  // From the video loop.
  /// Room that a snapshot needs from now on.
  void setPictureBytes(std::size_t bytes) {
    picture_bytes_.store(bytes, std::memory_order_relaxed);
  }
  bool pictureWanted();
  /// Copies the picture if one is asked for. Does not allocate.
  void offerPicture(const RgbaView& picture, std::int64_t frame);

 private:
  std::mutex mutex_;
  std::condition_variable answered_;
  std::optional<overlay::OverlaySettings> overlay_;
  std::atomic<std::size_t> picture_bytes_{0};
  bool wanted_ = false, ready_ = false;
  Snapshot snapshot_;
};

}  // namespace depthscope::platform
