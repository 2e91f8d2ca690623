#pragma once
#include <condition_variable>
#include <mutex>
#include <optional>
#include <vector>

#include "overlay/overlay_settings.hpp"
#include "types/image_view.hpp"

namespace depthscope::platform {

/// What the control socket asks of the video loop. The video loop only ever tries the lock: a
/// request that it misses is served with the next picture.
class VideoRequests {
 public:
  /// A picture as it was shown.
  struct Snapshot {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;  // R G B A, rows packed
  };

  // From the service's thread.
  void setOverlay(const overlay::OverlaySettings& settings);
  /// Waits for the next picture, for a second at most.
  std::optional<Snapshot> snapshot();

  // From the video loop.
  std::optional<overlay::OverlaySettings> takeOverlay();
  /// Copies the picture if one is asked for.
  void offerPicture(const RgbaView& picture);

 private:
  std::mutex mutex_;
  std::condition_variable answered_;
  std::optional<overlay::OverlaySettings> overlay_;
  bool wanted_ = false, ready_ = false;
  Snapshot snapshot_;
};

}  // namespace depthscope::platform
