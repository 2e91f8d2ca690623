#include "platform/daemon/video_loop.hpp"

#include <algorithm>

#include "capture/pixel_convert.hpp"
#include "platform/stopwatch.hpp"

namespace depthscope::platform {
namespace {

/// A missing picture is said on screen within 100 ms (promise 1 of the design), but a slow clip is
/// no fault.
std::chrono::nanoseconds readTimeout(double fps) {
  const std::chrono::duration<double> slow(fps > 0 ? 2.5 / fps : 0);
  return std::max<std::chrono::nanoseconds>(
      std::chrono::milliseconds(80), std::chrono::duration_cast<std::chrono::nanoseconds>(slow));
}

constexpr std::uint64_t pictures_per_percentile = 30;

std::size_t pixelCount(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

}  // namespace

VideoLoop::VideoLoop(capture::FrameSource& source, const CameraModel& camera,
                     const overlay::OverlaySettings& overlay, Display& display, ArLink& ar,
                     VideoRequests& requests, VideoReport& report)
    : source_(source),
      display_(display),
      ar_(ar),
      requests_(requests),
      report_(report),
      compositor_(camera, overlay),
      picture_(pixelCount(camera.width, camera.height) * 4),
      gray_(pixelCount(camera.width, camera.height)),
      width_(camera.width),
      height_(camera.height) {}

void VideoLoop::run(const std::stop_token& stop) {
  const std::chrono::nanoseconds timeout = readTimeout(source_.fps());
  while (!stop.stop_requested()) {
    const capture::ReadResult result = source_.read(timeout);
    report_.loops.fetch_add(1, std::memory_order_relaxed);
    report_.source_status.store(static_cast<std::uint8_t>(result.status),
                                std::memory_order_relaxed);
    if (result.status == capture::SourceStatus::EndOfStream) break;
    takeRequests();
    if (result.status == capture::SourceStatus::Ok)
      showPicture(result.frame);
    else
      showFault(result.status);
    report_.skipped.store(source_.skipped(), std::memory_order_relaxed);
    report_.rejected.store(ar_.rejected(), std::memory_order_relaxed);
  }
  report_.ended.store(true, std::memory_order_release);
}

void VideoLoop::takeRequests() {
  if (const auto settings = requests_.takeOverlay()) compositor_.setSettings(*settings);
}

void VideoLoop::showPicture(const capture::Frame& frame) {
  ar_.publish(frame, gray_);
  ar_.update(compositor_);
  width_ = frame.format.width;
  height_ = frame.format.height;
  shown_ = std::max(shown_ + 1,
                    static_cast<std::int64_t>(frame.sequence));  // fault pictures were counted too
  // Grows when the mode changes to a larger one, and then never again.
  if (picture_.size() < pixelCount(width_, height_) * 4)
    picture_.resize(pixelCount(width_, height_) * 4);
  const auto out = display_.acquire(width_, height_);
  if (out.empty()) {
    report_.given_up.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  const Stopwatch watch;
  const std::span picture = std::span(picture_).first(out.size());
  capture::toRgba(frame, picture);
  const overlay::OverlayState state = ar_.state(frame.capture_time);
  // On false the driver failed: the picture goes out without its overlay.
  if (!compositor_.composite({picture.data(), width_, height_, width_ * 4}, state, out))
    report_.overlay_failures.fetch_add(1, std::memory_order_relaxed);
  composite_ms_.add(watch.elapsedMs());
  present(out, width_, height_);
  report_.overlay_status.store(static_cast<std::uint8_t>(state.status), std::memory_order_relaxed);
  if (state.status == overlay::Status::Tracking)
    report_.tracked.fetch_add(1, std::memory_order_relaxed);
  if (report_.frames.fetch_add(1, std::memory_order_relaxed) % pictures_per_percentile == 0) {
    report_.composite_p50_ms.store(composite_ms_.percentile(0.5), std::memory_order_relaxed);
    report_.composite_p99_ms.store(composite_ms_.percentile(0.99), std::memory_order_relaxed);
  }
}

void VideoLoop::showFault(capture::SourceStatus status) {
  const auto out = display_.acquire(width_, height_);
  if (out.empty()) return;
  const bool late = status == capture::SourceStatus::Timeout;
  compositor_.compositeFault(width_, height_, late ? "no signal" : toString(status), out);
  ++shown_;
  present(out, width_, height_);
  report_.overlay_status.store(static_cast<std::uint8_t>(overlay::Status::NoSignal),
                               std::memory_order_relaxed);
  report_.faults.fetch_add(1, std::memory_order_relaxed);
}

void VideoLoop::present(std::span<std::uint8_t> picture, int width, int height) {
  requests_.offerPicture({picture.data(), width, height, width * 4});
  display_.present(shown_);
}

}  // namespace depthscope::platform
