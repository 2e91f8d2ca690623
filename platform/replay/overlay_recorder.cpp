#include "platform/replay/overlay_recorder.hpp"

#include <algorithm>

#include "capture/pixel_convert.hpp"
#include "platform/log.hpp"
#include "platform/png_writer.hpp"
#include "platform/stopwatch.hpp"

namespace depthscope::platform {
namespace {

std::size_t rgbaBytes(const CameraModel& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height) * 4;
}

}  // namespace

OverlayRecorder::OverlayRecorder(const CameraModel& camera,
                                 const overlay::OverlaySettings& settings, double fps,
                                 const std::filesystem::path& video)
    : width_(camera.width),
      height_(camera.height),
      max_age_ms_(settings.max_age_ms),
      compositor_(camera, settings),
      video_(video, camera.width, camera.height, fps),
      picture_(rgbaBytes(camera)),
      snapshot_(rgbaBytes(camera)) {}

bool OverlayRecorder::show(const capture::Frame& frame, overlay::OverlayState state,
                           std::int64_t index, VideoQueue::WhenFull when_full,
                           Histogram& composite_ms) {
  fade_out_.apply(state, max_age_ms_);
  const auto out = video_.acquire(when_full);
  if (out.empty()) return false;
  const Stopwatch watch;
  capture::toRgba(frame, picture_);
  // On false the picture is there without its overlay, and the next one may have it again.
  failed_composites_ +=
      !compositor_.composite({picture_.data(), width_, height_, width_ * 4}, state, out);
  composite_ms.add(watch.elapsedMs());
  if (state.status == overlay::Status::Tracking) {
    std::copy(out.begin(), out.end(), snapshot_.begin());
    has_snapshot_ = true;
  }
  video_.submit(index);
  return true;
}

void OverlayRecorder::finish(const std::filesystem::path& snapshot) {
  video_.finish();
  if (failed_composites_ > 0)
    log(LogPriority::Warning, "overlay left out, the graphics driver failed",
        {{"frames", failed_composites_}});
  if (has_snapshot_) writePng(snapshot, {snapshot_.data(), width_, height_, width_ * 4});
}

overlay::OverlayState overlayState(const PoseEstimate& estimate, double time_s) {
  overlay::OverlayState state;
  switch (estimate.state) {
    case TrackingState::Initializing:
      state.status = overlay::Status::Initializing;
      break;
    case TrackingState::Tracking:
      state.status = overlay::Status::Tracking;
      break;
    case TrackingState::Lost:
      state.status = overlay::Status::Lost;
      break;
  }
  state.T_camera_world = estimate.T_camera_world;
  state.map_id = estimate.map_id;
  state.confidence = estimate.confidence;
  state.age_ms = static_cast<float>(1e3 * (time_s - estimate.timestamp_s));
  state.time_s = time_s;
  return state;
}

}  // namespace depthscope::platform
