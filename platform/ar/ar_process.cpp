#include "platform/ar/ar_process.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "kernel/system_calls.hpp"
#include "platform/ar/capacity_text.hpp"
#include "platform/log.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr std::chrono::milliseconds heartbeat{100};  // at the latest
constexpr int pictures_per_percentile = 30;          // percentiles are worked out this often

SharedMemory attachChecked(ArOptions& options) {
  SharedMemory memory = SharedMemory::attach(std::move(options.shared_memory));
  const SharedCapacity& c = memory.capacity();
  if (options.camera.width != static_cast<int>(c.width) ||
      options.camera.height != static_cast<int>(c.height))
    throw InputError("shared memory: pictures of " + std::to_string(c.width) + "x" +
                     std::to_string(c.height) + ", expected the camera file's size");
  return memory;
}

}  // namespace

ArProcess::ArProcess(ArOptions options)
    : options_(std::move(options)),
      memory_(attachChecked(options_)),
      frames_(memory_),
      surfaces_(memory_),
      live_(options_.camera, options_.settings.slam, &options_.settings.recon),
      labels_({}),
      picture_(static_cast<std::size_t>(options_.camera.width) *
               static_cast<std::size_t>(options_.camera.height)),
      color_(memory_.colorSize().pixels()) {
  reserve(surface_, memory_.capacity());
  const slam::SlamMemory memory = live_.slam().memory();
  status_.keyframe_capacity = options_.settings.slam.capacity.keyframes;
  status_.map_point_capacity = options_.settings.slam.capacity.map_points;
  status_.slam_bytes = static_cast<std::int64_t>(memory.total());
  log(LogPriority::Info, "memory of SLAM set aside",
      {{"capacity", capacityText(options_.settings.slam, memory)}});
}

void ArProcess::run() {
  publishLabels();
  publishStatus();
  const kernel::Bell& bell = memory_.block().new_frame;
  for (std::uint32_t rings = bell.rings(); handleCommands(); rings = bell.rings()) {
    handlePicture();
    publishStatus();
    const int waited = kernel::realSystemCalls().waitForRing(bell, rings, heartbeat);
    if (waited < 0 && waited != -ETIMEDOUT && waited != -EINTR) return;  // rather than turn idly
  }
}

/// False when the video process is gone.
bool ArProcess::handleCommands() {
  WireCommand wire;
  for (;;) {
    const ssize_t got = ::recv(options_.commands.get(), &wire, sizeof wire, MSG_DONTWAIT);
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    if (got == 0) return false;
    WireCommand::Kind kind;
    LabelRequest label;
    if (got != static_cast<ssize_t>(sizeof wire) || !decodeCommand(wire, kind, label)) {
      log(LogPriority::Warning, "command not understood", {{"bytes", got}});
      continue;
    }
    if (kind == WireCommand::Reconstruct) live_.requestSurface();
    if (kind == WireCommand::Label) labels_.request(std::move(label));
    if (kind == WireCommand::Reset) reset();
    if (kind == WireCommand::SurfacePeriod) live_.setSurfacePeriod(wire.x);
  }
}

void ArProcess::reset() {
  live_.reset();
  labels_.clear();
  surface_.clear();
  publishLabels();
}

void ArProcess::handlePicture() {
  if (!frames_.takeNewest(picture_, color_, picture_info_)) return;
  const int width = options_.camera.width, height = options_.camera.height;
  const ColorReduction color = memory_.colorSize();
  estimate_ = live_.track({picture_.data(), width, height, width},
                          {color_.data(), color.width, color.height}, picture_info_.frame,
                          picture_info_.timestamp_s);
  memory_.block().pose.write(encodePose(estimate_));
  memory_.block().new_pose.ring();
  track_ms_.add(live_.slam().lastTimes().track_ms);
  ++status_.tracked_frames;
  publishView();
  publishSurface();
  if (labels_.anchorWaiting(surface_, options_.camera, estimate_)) publishLabels();
  if (status_.tracked_frames % pictures_per_percentile == 1) {
    status_.track_p50_ms = track_ms_.percentile(0.5);
    status_.track_p95_ms = track_ms_.percentile(0.95);
  }
}

void ArProcess::publishSurface() {
  if (!live_.takeSurface(surface_)) return;
  if (!surfaces_.publish(surface_)) {
    log(LogPriority::Warning, "surface does not fit into shared memory",
        {{"vertices", surface_.vertices.size()}, {"triangles", surface_.triangles.size()}});
    return;
  }
  ++status_.surfaces;
  status_.reconstruct_p50_ms = live_.reconstructTimes().percentile(0.5);
}

void ArProcess::publishView() {
  if (live_.takeView(view_)) memory_.block().view.write(encodeView(view_));
}

void ArProcess::publishLabels() {
  memory_.block().labels.write(encodeLabels(labels_.labels()));
}

void ArProcess::publishStatus() {
  const slam::SlamStatistics s = live_.slam().statistics();
  ++status_.beats;
  status_.keyframes = s.keyframes;
  status_.map_points = s.map_points;
  status_.maps = s.maps;
  status_.lost_events = s.lost_events;
  status_.relocalizations = s.relocalizations;
  status_.loops_closed = s.loops_closed;
  status_.readout_ms = 1000 * s.readout_s;
  status_.dropped_frames = static_cast<std::int64_t>(frames_.skipped());
  memory_.block().status.write(status_);
}

}  // namespace depthscope::platform
