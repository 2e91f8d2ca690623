#include "platform/daemon/ar_link.hpp"

#include <algorithm>

#include "capture/pixel_convert.hpp"

namespace depthscope::platform {

ArLink::ArLink(const SharedMemory& memory, float max_age_ms)
    : memory_(memory), max_age_ms_(max_age_ms), frames_(memory), surfaces_(memory) {
  color_.resize(memory.colorSize().pixels());
  reserve(surface_, memory.capacity());
  labels_.reserve(max_wire_labels);
  for (std::size_t i = 0; i < max_wire_labels; ++i)
    labels_.emplace_back().text.reserve(max_label_bytes);
}

void ArLink::setAlive(bool alive) {
  const std::uint32_t starts = starts_.load(std::memory_order_relaxed);
  if ((starts % 2 == 1) != alive) starts_.store(starts + 1, std::memory_order_release);
}

bool ArLink::fits(int width, int height) const {
  const SharedCapacity& c = memory_.capacity();
  return width == static_cast<int>(c.width) && height == static_cast<int>(c.height);
}

void ArLink::publish(const capture::Frame& frame, std::vector<std::uint8_t>& gray) {
  if (!fits(frame.format.width, frame.format.height)) return;
  GrayView luma = frame.luma();
  if (luma.empty()) {
    capture::toGray(frame, gray);
    luma = {gray.data(), frame.format.width, frame.format.height, frame.format.width};
  }
  const auto index = static_cast<std::int64_t>(frame.sequence);
  published_.add(index, frame.capture_time);
  capture::toReducedRgb(frame, color_);
  const ColorReduction size = memory_.colorSize();
  frames_.publish(luma, {color_.data(), size.width, size.height}, {index, frame.media_time_s});
}

/// The map ids of another process mean other maps.
void ArLink::forget(overlay::Compositor& compositor) {
  surfaces_.takeNewest(surface_);
  surface_.clear();
  labels_.clear();
  // Twice, for the one before would still fade away, under poses of another process.
  for (int i = 0; i < 2; ++i) compositor.setSurface(surface_);
  compositor.setLabels(labels_);
  predictor_.reset();
  fade_out_.reset();
}

void ArLink::update(overlay::Compositor& compositor) {
  const std::uint32_t starts = starts_.load(std::memory_order_acquire);
  const bool another = starts != starts_seen_;
  starts_seen_ = starts;
  if (starts % 2 == 0) return;
  if (another) forget(compositor);
  updateSurface(compositor);
  updateLabels(compositor);
  updateView(compositor);
}

void ArLink::updateSurface(overlay::Compositor& compositor) {
  switch (surfaces_.takeNewest(surface_)) {
    case SurfaceMailboxReader::Result::Taken:
      compositor.setSurface(surface_);
      break;
    case SurfaceMailboxReader::Result::Rejected:
      reject();
      break;
    case SurfaceMailboxReader::Result::Nothing:
      break;
  }
}

void ArLink::updateLabels(overlay::Compositor& compositor) {
  std::uint64_t count = 0;
  if (!memory_.block().labels.read(wire_labels_, &count) || count == labels_seen_) return;
  labels_seen_ = count;
  if (decodeLabels(wire_labels_, labels_))
    compositor.setLabels(labels_);
  else
    reject();
}

void ArLink::updateView(overlay::Compositor& compositor) {
  std::uint64_t count = 0;
  if (!memory_.block().view.read(wire_view_, &count) || count == view_seen_) return;
  view_seen_ = count;
  if (decodeView(wire_view_, view_))
    compositor.setView(view_);
  else
    reject();
}

ArLink::View ArLink::view(PublishedFrames::Time captured, int width, int height) {
  View view;
  overlay::OverlayState& state = view.state;
  state.time_s = std::chrono::duration<double>(captured.time_since_epoch()).count();
  if (!fits(width, height)) {
    state.message = "picture size is not the camera file's";
    return view;
  }
  takePose(captured, state);
  fade_out_.apply(state, max_age_ms_);
  view.posed = state.fading || state.status == overlay::Status::Tracking;
  if (view.posed) {
    state.T_camera_world = predictor_.at(captured);
    view.pose_captured = pose_captured_;
  }
  return view;
}

/// The newest pose, if it is one to draw by; the status says why not.
void ArLink::takePose(PublishedFrames::Time captured, overlay::OverlayState& state) {
  if (starts_seen_ % 2 == 0) return;
  WirePose wire;
  PoseEstimate pose;
  state.status = overlay::Status::Initializing;
  if (!memory_.block().pose.read(wire)) return;
  state.status = overlay::Status::Stale;
  if (!decodePose(wire, pose)) return reject();
  const auto pose_time = published_.captured(pose.frame);
  const float age_ms = pose_time
                           ? std::chrono::duration<float, std::milli>(captured - *pose_time).count()
                           : max_age_ms_ + 1;
  // A pose may be newer than the picture: of the next one, found while this was waiting to be drawn
  // over. One of a picture that was never given out is none to draw with.
  if (age_ms > max_age_ms_) return;
  state.status = pose.state == TrackingState::Initializing ? overlay::Status::Initializing
                                                           : overlay::Status::Lost;
  if (pose.state != TrackingState::Tracking) return;
  state.status = overlay::Status::Tracking;
  predictor_.add(pose.T_camera_world, pose.map_id, *pose_time);
  pose_captured_ = *pose_time;
  state.map_id = pose.map_id;
  state.confidence = pose.confidence;
  state.age_ms = std::max(age_ms, 0.0f);
}

std::optional<PoseEstimate> ArLink::trackedPose(PublishedFrames::Time now) const {
  WirePose wire;
  PoseEstimate pose;
  if (starts_.load(std::memory_order_acquire) % 2 == 0 || !memory_.block().pose.read(wire) ||
      !decodePose(wire, pose) || pose.state != TrackingState::Tracking)
    return std::nullopt;
  const auto at = published_.captured(pose.frame);
  const std::chrono::duration<float, std::milli> most(max_age_ms_);
  if (!at || now - *at > most) return std::nullopt;
  return pose;
}

}  // namespace depthscope::platform
