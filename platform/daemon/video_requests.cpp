#include "platform/daemon/video_requests.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace depthscope::platform {

void VideoRequests::setOverlay(const overlay::OverlaySettings& settings) {
  const std::lock_guard lock(mutex_);
  overlay_ = settings;
}

std::optional<overlay::OverlaySettings> VideoRequests::takeOverlay() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return std::nullopt;
  return std::exchange(overlay_, std::nullopt);
}

std::optional<VideoRequests::Snapshot> VideoRequests::snapshot() {
  std::unique_lock lock(mutex_);
  wanted_ = true;
  const bool came = answered_.wait_for(lock, std::chrono::seconds(1), [this] { return ready_; });
  wanted_ = ready_ = false;
  if (!came) return std::nullopt;
  return snapshot_;
}

void VideoRequests::offerPicture(const RgbaView& picture) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || !wanted_ || ready_) return;
  snapshot_.width = picture.width;
  snapshot_.height = picture.height;
  snapshot_.pixels.assign(picture.data, picture.data + picture.stride * picture.height);
  ready_ = true;
  answered_.notify_one();
}

}  // namespace depthscope::platform
