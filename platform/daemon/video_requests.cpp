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
  snapshot_.pixels.reserve(picture_bytes_.load(std::memory_order_relaxed));
  wanted_ = true;
  const bool came = answered_.wait_for(lock, std::chrono::seconds(1), [this] { return ready_; });
  wanted_ = ready_ = false;
  if (!came) return std::nullopt;
  return snapshot_;
}

bool VideoRequests::pictureWanted() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  return lock.owns_lock() && wanted_ && !ready_;
}

void VideoRequests::offerPicture(const RgbaView& picture, std::int64_t frame) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || !wanted_ || ready_) return;
  // The size changed just now: the one who asks makes room and asks again.
  const auto bytes =
      static_cast<std::size_t>(picture.stride) * static_cast<std::size_t>(picture.height);
  if (bytes > snapshot_.pixels.capacity()) return;
  snapshot_.width = picture.width;
  snapshot_.height = picture.height;
  snapshot_.frame = frame;
  snapshot_.pixels.assign(picture.data, picture.data + picture.stride * picture.height);
  ready_ = true;
  answered_.notify_one();
}

}  // namespace depthscope::platform
