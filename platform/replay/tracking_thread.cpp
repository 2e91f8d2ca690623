#include "platform/replay/tracking_thread.hpp"

#include <algorithm>
#include <utility>

namespace depthscope::platform {

TrackingThread::TrackingThread(const CameraModel& camera, const slam::SlamSettings& slam,
                               const recon::ReconSettings* recon, std::int64_t expected_frames)
    : width_(camera.width),
      height_(camera.height),
      color_size_(camera.width, camera.height),
      live_(camera, slam, recon),
      record_(expected_frames) {
  waiting_.pixels.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  thread_ = std::thread([this] { run(); });
}

TrackingThread::~TrackingThread() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

void TrackingThread::offer(const GrayView& luma, const RgbView& color, std::int64_t frame,
                           double timestamp_s) {
  const std::lock_guard lock(mutex_);
  if (error_) std::rethrow_exception(error_);
  for (int y = 0; y < height_; ++y)
    std::copy_n(luma.row(y), width_,
                waiting_.pixels.data() + static_cast<std::ptrdiff_t>(y) * width_);
  waiting_.color.assign(color.data, color.data + color_size_.pixels());
  waiting_.frame = frame;
  waiting_.timestamp_s = timestamp_s;
  has_waiting_ = true;
  changed_.notify_one();
}

PoseEstimate TrackingThread::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

bool TrackingThread::takeSurface(SurfaceMesh& mesh) {
  const std::lock_guard lock(mutex_);
  if (!has_surface_) return false;
  std::swap(mesh, surface_);
  has_surface_ = false;
  return true;
}

bool TrackingThread::takeView(ViewOutline& view) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(has_view_, false)) return false;
  view = view_;
  return true;
}

void TrackingThread::run() {
  try {
    loop();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    error_ = std::current_exception();
  }
}

void TrackingThread::loop() {
  Picture picture;
  picture.pixels.resize(waiting_.pixels.size());
  SurfaceMesh mesh;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return has_waiting_ || stopping_; });
      if (!has_waiting_) return;
      std::swap(picture, waiting_);
      has_waiting_ = false;
    }
    const PoseEstimate estimate =
        live_.track({picture.pixels.data(), width_, height_, width_},
                    {picture.color.data(), color_size_.width, color_size_.height}, picture.frame,
                    picture.timestamp_s);
    record_.add(estimate, live_.slam().lastTimes());
    const bool new_surface = live_.takeSurface(mesh);
    const std::lock_guard lock(mutex_);
    newest_ = estimate;
    has_view_ |= live_.takeView(view_);
    if (!new_surface) continue;
    std::swap(mesh, surface_);
    has_surface_ = true;
  }
}

void TrackingThread::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(error_);
}

}  // namespace depthscope::platform
