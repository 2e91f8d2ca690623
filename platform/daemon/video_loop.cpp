#include "platform/daemon/video_loop.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

#include "capture/pixel_convert.hpp"
#include "overlay/blend.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::platform {
namespace {

using capture::SourceStatus;
using std::chrono::duration;
using std::chrono::nanoseconds;

constexpr std::string_view stale_message = "no new picture";
constexpr std::uint64_t pictures_per_summary = 30;
constexpr double usual_fps = 30;

nanoseconds toNanoseconds(double seconds) {
  return std::chrono::duration_cast<nanoseconds>(duration<double>(seconds));
}

/// A missing picture is said on screen within 100 ms (promise 1 of the design), but a slow clip is
/// no fault.
nanoseconds readTimeout(double fps) {
  return std::max<nanoseconds>(std::chrono::milliseconds(80),
                               toNanoseconds(fps > 0 ? 1.6 / fps : 0));
}

std::size_t byteCount(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
}

std::string_view faultMessage(SourceStatus status) {
  return status == SourceStatus::Timeout ? stale_message : toString(status);
}

}  // namespace

VideoLoop::VideoLoop(const Parts& parts, const VideoLoopSettings& settings,
                     const std::string& font_file, int width, int height)
    : parts_(parts),
      settings_(settings),
      painter_(font_file),
      camera_width_(width),
      camera_height_(height),
      ledger_(parts.log) {
  resize(width, height);
}

/// Room for pictures of this size, and everything that may have to be said in them.
void VideoLoop::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  const std::size_t bytes = byteCount(width, height);
  if (picture_.size() < bytes) picture_.resize(bytes);
  if (gray_.size() < bytes / 4) gray_.resize(bytes / 4);
  std::vector<std::string_view> messages{stale_message};
  for (int s = 0; s < capture::source_status_count; ++s)
    messages.push_back(faultMessage(static_cast<SourceStatus>(s)));
  painter_.prepare(width, height, messages);
  parts_.requests.setPictureBytes(bytes);
  overlay_deadline_.reset();
  last_picture_.reset();
}

void VideoLoop::run(const std::stop_token& stop) {
  while (!stop.stop_requested() && turn()) {
  }
  parts_.report.ended.store(true, std::memory_order_release);
}

bool VideoLoop::turn() {
  const AllocationScope scope;
  capture::ReadResult result = parts_.source.read(readTimeout(parts_.source.fps()));
  VideoReport& report = parts_.report;
  report.source_status.store(static_cast<std::uint8_t>(result.status), std::memory_order_relaxed);
  if (result.status == SourceStatus::EndOfStream) return false;
  noteSource(result);
  if (result.status == SourceStatus::Ok)
    showPicture(result.frame);
  else
    showFault(result.status);
  report.note(parts_.display);
  report.skipped.store(parts_.source.skipped(), std::memory_order_relaxed);
  report.damaged.store(parts_.source.damagedFrames(), std::memory_order_relaxed);
  report.rejected.store(parts_.ar.rejected(), std::memory_order_relaxed);
  return true;
}

/// Changes of the source are for the log, which the service writes.
void VideoLoop::noteSource(const capture::ReadResult& result) {
  if (result.status == SourceStatus::Timeout) return;  // a pause is no news
  if (result.status != noted_status_ || result.format_changed) noted_ = false;
  noted_status_ = result.status;
  if (noted_) return;
  if (result.status != SourceStatus::Ok) {
    noted_ = parts_.report.source_note.put(result.status, parts_.source.detail());
    return;
  }
  const capture::FrameFormat& format = result.frame.format;
  const bool calibrated = format.width == camera_width_ && format.height == camera_height_;
  std::array<char, 160> text{};
  const int length =
      std::snprintf(text.data(), text.size(), "%dx%d%s", format.width, format.height,
                    calibrated ? "" : ", no AR: the camera file is for another size");
  noted_ =
      parts_.report.source_note.put(result.status, {text.data(), static_cast<std::size_t>(length)});
}

void VideoLoop::showPicture(capture::Frame& frame) {
  FrameTimes times;
  times.sequence = frame.sequence;
  times.captured = frame.capture_time;
  times.dequeued = parts_.system.now();
  times.damaged = frame.damaged;
  resize(frame.format.width, frame.format.height);
  parts_.ar.publish(frame, gray_);
  const double fps = parts_.source.fps() > 0 ? parts_.source.fps() : usual_fps;
  const Time deadline =
      overlay_deadline_.next(times.captured, times.dequeued,
                             toNanoseconds(static_cast<double>(settings_.overlay_wait) / fps));
  parts_.layers.request({++requests_, width_, height_, static_cast<std::int64_t>(frame.sequence),
                         frame.damaged, frame.capture_time, deadline});
  // Fault pictures were counted too.
  shown_ = std::max(shown_ + 1, static_cast<std::int64_t>(frame.sequence));
  const bool direct = parts_.display.takesFrame(frame);
  if (!direct) capture::toRgba(frame, picture_);
  times.uploaded = parts_.system.now();

  const auto out = parts_.display.acquire(width_, height_);
  if (out.empty()) return giveUp(frame, times);
  layer_ = parts_.layers.newest(deadline);
  times.overlaid = parts_.system.now();
  const OverlayLayer* layer = usableLayer(frame.capture_time);
  noteLayer(layer, times);
  if (!direct || !presentDirect(frame, layer, out, times)) {
    if (frame.empty()) return giveUp(frame, times);
    if (direct) capture::toRgba(frame, picture_);
    compose(layer, out);
    times.composited = parts_.system.now();
    present(out, static_cast<std::int64_t>(times.sequence));
    times.submitted = parts_.system.now();
  }
  last_picture_ = times.dequeued;
  parts_.report.frames.fetch_add(1, std::memory_order_relaxed);
  account(times);
}

/// The display does not take the picture. It is the last one all the same.
void VideoLoop::giveUp(const capture::Frame& frame, const FrameTimes& times) {
  if (!frame.empty()) {
    capture::toRgba(frame, picture_);
    last_picture_ = times.dequeued;
  }
  parts_.report.given_up.fetch_add(1, std::memory_order_relaxed);
}

/// Gives the display the picture itself, where its hardware can lay the overlay over it. What else
/// the picture is wanted for comes after that.
bool VideoLoop::presentDirect(capture::Frame& frame, const OverlayLayer* layer,
                              std::span<std::uint8_t> out, FrameTimes& times) {
  const LayerView view = layer != nullptr
                             ? LayerView{layer->pixels.data(), width_, height_, layer->rect}
                             : markLayer();
  const capture::Frame* held = parts_.display.presentFrame(frame, view, shown_);
  if (held == nullptr) return false;
  times.composited = times.submitted = parts_.system.now();
  parts_.report.presented.fetch_add(1, std::memory_order_release);
  capture::toRgba(*held, picture_);
  if (parts_.requests.pictureWanted()) {
    compose(layer, out);
    parts_.requests.offerPicture({out.data(), width_, height_, width_ * 4},
                                 static_cast<std::int64_t>(times.sequence));
  }
  return true;
}

/// A layer with nothing in it but the mark that says that there is no overlay.
LayerView VideoLoop::markLayer() {
  if (mark_layer_.size() < byteCount(width_, height_))
    mark_layer_.resize(byteCount(width_, height_));
  const overlay::Mark mark = missingMark();
  const overlay::PixelRect rect =
      painter_.markRect(width_, height_, mark, {}).clipped({0, 0, width_, height_});
  for (int y = rect.y0; y < rect.y1; ++y)
    std::fill_n(mark_layer_.begin() + static_cast<std::ptrdiff_t>(byteCount(width_, y)) +
                    std::ptrdiff_t{4} * rect.x0,
                4 * rect.width(), std::uint8_t{0});
  painter_.paintMarkOnLayer(mark, {}, width_, height_, mark_layer_, rect);
  return {mark_layer_.data(), width_, height_, rect};
}

/// What is said while there is no overlay to show.
overlay::Mark VideoLoop::missingMark() const {
  return layer_ != nullptr ? overlay::Mark::Stale : overlay::Mark::NoAr;
}

/// The newest overlay, if it fits the picture and its pose is not too old for it.
const OverlayLayer* VideoLoop::usableLayer(Time captured) const {
  if (layer_ == nullptr || layer_->width != width_ || layer_->height != height_) return nullptr;
  const Time from = layer_->posed ? layer_->pose_captured : layer_->captured;
  const duration<float, std::milli> age = captured - from;
  return age.count() <= settings_.max_age_ms ? layer_ : nullptr;
}

/// Lays the overlay over the picture, or else a mark that says that there is none.
void VideoLoop::compose(const OverlayLayer* layer, std::span<std::uint8_t> out) {
  const std::size_t row = byteCount(width_, 1);
  if (layer == nullptr) {
    std::memcpy(out.data(), picture_.data(), byteCount(width_, height_));
    painter_.paintMark(missingMark(), {}, out, width_, height_);
    return;
  }
  for (int y = 0; y < height_; ++y) {
    const std::size_t at = row * static_cast<std::size_t>(y);
    if (y >= layer->rect.y0 && y < layer->rect.y1)
      overlay::blendRow(layer->pixels.data() + at, picture_.data() + at, out.data() + at, width_);
    else
      std::memcpy(out.data() + at, picture_.data() + at, row);
  }
}

void VideoLoop::noteLayer(const OverlayLayer* layer, FrameTimes& times) {
  if (layer == nullptr) {
    const auto status = layer_ != nullptr ? overlay::Status::Stale : overlay::Status::NoAr;
    times.overlay_status = static_cast<std::uint8_t>(status);
    return;
  }
  times.overlay_status = static_cast<std::uint8_t>(layer->status);
  if (!layer->drawn) parts_.report.overlay_failures.fetch_add(1, std::memory_order_relaxed);
  if (layer->number != requests_)
    parts_.report.late_overlays.fetch_add(1, std::memory_order_relaxed);
  if (!layer->posed) return;
  const duration<float, std::milli> age = times.captured - layer->pose_captured;
  times.overlay_age_ms = std::max(age.count(), 0.0f);
}

void VideoLoop::account(const FrameTimes& times) {
  ledger_.submitted(shown_, times);
  // What the display has learnt meanwhile about when pictures were on the glass.
  while (const auto shown = parts_.display.takeShown()) ledger_.shown(shown->index, shown->shown);
  VideoReport& report = parts_.report;
  report.overlay_status.store(times.overlay_status, std::memory_order_relaxed);
  if (times.overlay_status == static_cast<std::uint8_t>(overlay::Status::Tracking))
    report.tracked.fetch_add(1, std::memory_order_relaxed);
  if (report.frames.load(std::memory_order_relaxed) % pictures_per_summary == 1)
    report.times.write(ledger_.summary());
}

/// A source that only pauses keeps its last picture for a while, darkened and marked; one that says
/// what is wrong has that said in a picture of its own.
void VideoLoop::showFault(SourceStatus status) {
  const auto out = parts_.display.acquire(width_, height_);
  if (out.empty()) return;
  const bool pause = status == SourceStatus::Timeout && last_picture_ &&
                     parts_.system.now() - *last_picture_ < toNanoseconds(settings_.stale_s);
  if (pause) {
    std::memcpy(out.data(), picture_.data(), byteCount(width_, height_));
    painter_.paintStale(stale_message, out, width_, height_);
    parts_.report.stale.fetch_add(1, std::memory_order_relaxed);
  } else {
    painter_.paintFault(faultMessage(status), out, width_, height_);
  }
  ++shown_;
  present(out, -1);
  parts_.report.overlay_status.store(static_cast<std::uint8_t>(overlay::Status::NoSignal),
                                     std::memory_order_relaxed);
  parts_.report.faults.fetch_add(1, std::memory_order_relaxed);
}

/// `frame`: number of the picture from the scope, negative for another.
void VideoLoop::present(std::span<std::uint8_t> picture, std::int64_t frame) {
  parts_.requests.offerPicture({picture.data(), width_, height_, width_ * 4}, frame);
  parts_.display.present(shown_);
  parts_.report.presented.fetch_add(1, std::memory_order_release);
}

}  // namespace depthscope::platform
