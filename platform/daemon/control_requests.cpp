#include "platform/daemon/control_requests.hpp"

#include <sys/stat.h>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "capture/frame_source.hpp"
#include "overlay/compositor.hpp"
#include "platform/config/config_file.hpp"
#include "platform/display/display.hpp"
#include "platform/ipc/surface_mailbox.hpp"
#include "platform/peak_memory.hpp"
#include "platform/png_writer.hpp"
#include "platform/surface_writer.hpp"
#include "platform/utf8.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

constexpr int snapshot_tries = 3;  // for a picture that can be measured in
constexpr std::string_view no_ar = "error no AR process runs at the moment";

const char* overlayStatusName(std::uint8_t status) {
  switch (static_cast<overlay::Status>(status)) {
    case overlay::Status::NoAr:
      return "no AR";
    case overlay::Status::Initializing:
      return "initializing";
    case overlay::Status::Tracking:
      return "tracking";
    case overlay::Status::Lost:
      return "lost";
    case overlay::Status::Stale:
      return "stale";
    case overlay::Status::NoSignal:
      return "no signal";
  }
  return "unknown";
}

nlohmann::ordered_json toJson(const DurationSummary& s) {
  return {{"count", s.count}, {"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

bool writeAll(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

ControlRequests::ControlRequests(Settings& settings, const CameraModel& camera,
                                 const SharedMemory& memory, ArSupervisor& ar, VideoRequests& video,
                                 const VideoReport& report, const Footswitch& footswitch,
                                 MapScaleKeeper& scale)
    : settings_(settings),
      camera_(camera),
      memory_(memory),
      ar_(ar),
      video_(video),
      report_(report),
      footswitch_(footswitch),
      scale_(scale) {}

std::string ControlRequests::footswitchPressed() {
  switch (settings_.footswitch.action) {
    case FootswitchAction::Reconstruct:
      return handle("reconstruct", {});
    case FootswitchAction::OverlayToggle:
      return handle("overlay toggle", {});
    case FootswitchAction::Snapshot:
      return handle("snapshot", {});
  }
  return "error unknown action";
}

std::string ControlRequests::handle(std::string_view line, UniqueFd attached) {
  const auto space = line.find(' ');
  const std::string_view verb = line.substr(0, space);
  const std::string_view rest =
      space == std::string_view::npos ? std::string_view() : line.substr(space + 1);
  if (verb == "status") return "ok " + status();
  if (verb == "reconstruct") return command(encodeCommand(WireCommand::Reconstruct));
  if (verb == "reset") return reset();
  if (verb == "label") return label(rest, {camera_.width / 2.0, camera_.height / 2.0});
  if (verb == "label-at") return labelAt(rest);
  if (verb == "overlay") return overlay(rest);
  if (verb == "snapshot") return snapshot();
  if (verb == "scale") return scale(rest);
  if (verb == "export") return exportSurface(rest, std::move(attached));
  return "error unknown request";
}

std::string ControlRequests::command(const WireCommand& command) {
  return ar_.send(command) ? "ok" : std::string(no_ar);
}

std::string ControlRequests::reset() {
  scale_.forget();
  return command(encodeCommand(WireCommand::Reset));
}

std::string ControlRequests::label(std::string_view text, const Eigen::Vector2d& pixel) {
  if (text.empty() || text.size() >= max_label_bytes || !isPrintableUtf8(text))
    return "error expected a text of 1 to " + std::to_string(max_label_bytes - 1) + " bytes, UTF-8";
  return command(encodeCommand(WireCommand::Label, {std::string(text), pixel}));
}

std::string ControlRequests::labelAt(std::string_view rest) {
  const auto space = rest.find(' ');
  if (space == std::string_view::npos) return "error expected X,Y TEXT";
  try {
    const LabelRequest request = parseLabelRequest(std::string(rest.substr(space + 1)) + "@" +
                                                   std::string(rest.substr(0, space)));
    const Eigen::Vector2d& p = request.pixel;
    if (p.x() < 0 || p.y() < 0 || p.x() >= camera_.width || p.y() >= camera_.height)
      return "error expected a place inside the picture of " + std::to_string(camera_.width) + "x" +
             std::to_string(camera_.height);
    return label(request.text, p);
  } catch (const InputError&) {
    return "error expected X,Y in pixels";
  }
}

std::string ControlRequests::overlay(std::string_view mode) {
  overlay::CueMode& cue = settings_.overlay.cue;
  if (cue != overlay::CueMode::Off) shown_cue_ = cue;
  try {
    if (mode == "toggle")
      cue = cue == overlay::CueMode::Off ? shown_cue_ : overlay::CueMode::Off;
    else
      applyOverride("overlay.cue=" + std::string(mode), settings_);
  } catch (const InputError& error) {
    return std::string("error ") + error.what();
  }
  video_.setOverlay(settings_.overlay);
  return "ok";
}

std::string ControlRequests::snapshot() {
  auto picture = video_.snapshot();
  for (int tries = 1; picture && !scale_.noteSnapshot(picture->frame) && tries < snapshot_tries;
       ++tries)
    picture = video_.snapshot();
  if (!picture) return "error no picture came within a second";
  const std::filesystem::path folder = settings_.daemon.state_dir;
  char name[64];
  std::tm utc{};
  const std::time_t now = std::time(nullptr);
  ::gmtime_r(&now, &utc);
  std::strftime(name, sizeof name, "snapshot-%Y%m%dT%H%M%SZ", &utc);
  try {
    std::filesystem::create_directories(folder);
    std::filesystem::path file = folder / (std::string(name) + ".png");
    for (int i = 2; std::filesystem::exists(file); ++i)
      file = folder / (std::string(name) + "-" + std::to_string(i) + ".png");
    writePng(file, {picture->pixels.data(), picture->width, picture->height, picture->width * 4});
    return "ok " + file.string();
  } catch (const std::exception& error) {
    return std::string("error ") + error.what();
  }
}

std::string ControlRequests::scale(std::string_view rest) {
  try {
    return "ok " + toString(scale_.measure(rest));
  } catch (const InputError& error) {
    return std::string("error ") + error.what();
  }
}

std::string ControlRequests::exportSurface(std::string_view format, UniqueFd file) const {
  const auto known = surfaceFormat(format);
  if (!known) return "error expected ply, obj or stl";
  struct stat info {};
  // Only a regular file is sure not to hold the service up.
  if (!file.valid() || ::fstat(file.get(), &info) != 0 || !S_ISREG(info.st_mode))
    return "error expected an open file";
  SurfaceMesh mesh;
  SurfaceMailboxReader reader(memory_);
  if (reader.takeNewest(mesh) != SurfaceMailboxReader::Result::Taken || mesh.empty())
    return "error there is no surface yet";
  std::ostringstream text;
  const std::optional<MapScale> scale = scale_.of(mesh);
  writeSurface(text, mesh, *known, scale);
  if (!writeAll(file.get(), text.view())) return "error the file cannot be written";
  return "ok " + std::to_string(mesh.triangles.size()) + " triangles, " +
         (scale ? "in mm: " + toString(*scale) : "up to scale");
}

std::string ControlRequests::status() const {
  nlohmann::ordered_json json{
      {"version", DEPTHSCOPE_VERSION},
      {"uptime_s",
       std::floor(
           std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count())},
      {"source", toString(static_cast<capture::SourceStatus>(report_.source_status.load()))},
      {"display", toString(static_cast<DisplayState>(report_.display_state.load()))},
      {"display_width", report_.display_width.load()},
      {"display_height", report_.display_height.load()},
      {"display_refresh_hz", report_.display_refresh_hz.load()},
      {"footswitch", footswitch_.state()},
      {"footswitch_presses", footswitch_.presses()},
      {"footswitch_lost_events", footswitch_.lost()},
      {"overlay", overlayStatusName(report_.overlay_status.load())},
      {"frames_shown", report_.frames.load()},
      {"frames_skipped", report_.skipped.load()},
      {"frames_damaged", report_.damaged.load()},
      {"frames_given_up", report_.given_up.load()},
      {"frames_tracked", report_.tracked.load()},
      {"fault_pictures", report_.faults.load()},
      {"overlay_failures", report_.overlay_failures.load()},
      {"stale_pictures", report_.stale.load()},
      {"late_overlays", report_.late_overlays.load()},
      {"peak_rss_mb", peakResidentMb()},
      {"ar_alive", ar_.alive()},
      {"ar_pid", ar_.pid()},
      {"ar_restarts", ar_.restarts()},
      {"ar_rejected", report_.rejected.load()}};
  FrameClockSummary times;
  if (report_.times.read(times)) {
    json["video_delay_ms"] = toJson(times.video_delay);
    json["shown_delay_ms"] = toJson(times.shown_delay);
    json["overlay_age_ms"] = toJson(times.overlay_age);
    json["stages_ms"] = {{"dequeue", toJson(times.dequeue)},
                         {"upload", toJson(times.upload)},
                         {"overlay_wait", toJson(times.overlay_wait)},
                         {"blend", toJson(times.blend)},
                         {"submit", toJson(times.submit)}};
  }
  const auto scale = scale_.ofTrackedMap();
  json["scale"] = scale ? toString(scale->from) : "up to scale";
  json["mm_per_unit"] = scale ? nlohmann::ordered_json(scale->mm_per_unit) : nullptr;
  json["mm_per_unit_uncertainty"] = scale ? nlohmann::ordered_json(scale->uncertainty_mm) : nullptr;
  WireArStatus ar;
  if (ar_.alive() && memory_.block().status.read(ar) && plausible(ar)) {
    json["keyframes"] = ar.keyframes;
    json["map_points"] = ar.map_points;
    json["keyframe_capacity"] = ar.keyframe_capacity;
    json["map_point_capacity"] = ar.map_point_capacity;
    json["slam_mb"] = static_cast<double>(ar.slam_bytes) / (1024.0 * 1024.0);
    json["maps"] = ar.maps;
    json["lost_events"] = ar.lost_events;
    json["relocalizations"] = ar.relocalizations;
    json["loops_closed"] = ar.loops_closed;
    json["readout_ms"] = ar.readout_ms;
    json["surfaces"] = ar.surfaces;
    json["ar_frames"] = ar.tracked_frames;
    json["ar_dropped_frames"] = ar.dropped_frames;
    json["track_p50_ms"] = ar.track_p50_ms;
    json["track_p95_ms"] = ar.track_p95_ms;
    json["reconstruct_p50_ms"] = ar.reconstruct_p50_ms;
  }
  return json.dump();
}

}  // namespace depthscope::platform
