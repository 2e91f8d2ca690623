// The list of all configuration keys. To add one: add the field to its module's settings struct,
// and one line here, or in setting_bindings_seeing.cpp.
#include "platform/config/setting_binder.hpp"

namespace depthscope::platform {
namespace {

void bindCapture(SettingBinder& b, CaptureSettings& s) {
  b.section("capture");
  b.text("device", s.card.device,
         "capture card: \"auto\", a path such as /dev/v4l/by-path/..., \"name:TEXT\" or "
         "\"bus:TEXT\" (depthscope devices lists them); empty: none, input is used");
  b.text("device_input", s.card.input, "of the card, by name or number; empty: as it is set");
  b.text("edid", s.card.edid,
         "what the card tells the tower: \"auto\" the built-in one where it has none, "
         "\"builtin\", \"none\" to leave it, or a binary file");
  b.text("pixel_format", s.card.pixel_format,
         "of the card, four characters such as \"NV12\"; \"auto\": the best it has");
  b.number("width", s.card.width, 0, 16384,
           "[px] wanted of cards that offer a choice; 0: the camera file's");
  b.number("height", s.card.height, 0, 16384, "[px] likewise");
  b.number("retry_ms", s.card.retry_ms, 10, 100,
           "pause between attempts to get a card or its signal back");
  b.number("restart_ms", s.card.restart_ms, 200, 60000,
           "no picture for so long although there is a signal: the card is opened anew");
  b.text("input", s.input, "video file or folder of images that stands for the endoscope");
  b.text("camera", s.camera, "camera file, as depthscope calibrate writes it");
  b.flag("loop", s.loop,
         "play the clip again at its end; without it the daemon ends with the clip");
  b.number("fps", s.fps, 0, 240,
           "pictures a second; 0: the camera file's, else the clip's own; the signal's where it "
           "has one");
  b.number("buffers", s.buffers, 4, 32, "pictures in the card's queue or the clip's pool");
  b.text("faults", s.faults, "fault script to act out; empty: none");
}

void bindOverlay(SettingBinder& b, overlay::OverlaySettings& s) {
  b.section("overlay");
  b.live(true);
  b.choice("cue", s.cue, {"off", "chromadepth", "mesh"}, "how depth is shown");
  b.number("opacity", s.opacity, 0, 1, "of the cue over the picture");
  b.flag("inset", s.inset, "the turned-aside view of the mesh in a corner");
  b.flag("labels", s.labels, "show labels");
  b.number("gone_confidence", s.gone_confidence, 0, 1,
           "of the pose, at or below which nothing is drawn over the picture");
  b.number("full_confidence", s.full_confidence, 0, 1,
           "of the pose, from which the overlay has its whole strength");
  b.number("crossfade_s", s.crossfade_s, 0, 10, "from one surface to the next");
  b.number("border_fade", s.border_fade, 0, 0.5, "width of the surface's soft border, of the mesh");
  b.number("inset_turn_deg", s.inset_turn_deg, -89, 89,
           "of the turned-aside view, about the picture's vertical axis");
  b.number("inset_width", s.inset_width, 0.05, 0.5, "of the picture's width");
  b.live(false);
  b.number("max_age_ms", s.max_age_ms, 10, 10000,
           "an overlay older than this is gone; it fades before");
  b.number("label_height_px", s.label_height_px, 0, 400,
           "of the text; 0: from the picture's height");
  b.text("font_file", s.font_file, "TrueType file; empty: DejaVu Sans where Debian puts it");
  b.number("max_triangles", s.max_triangles, 1000, 1000000,
           "drawn of a surface; one of more is made coarser first");
  b.number("max_labels", s.max_labels, 0, 256,
           "memory is set aside for so many; later ones are left out");
}

void bindDisplay(SettingBinder& b, DisplaySettings& s) {
  b.section("display");
  b.choice(
      "kind", s.kind, {"null", "file", "kms", "fbdev"},
      "where the pictures go: nowhere, into a video file, to a monitor, to a bare framebuffer");
  b.text("path", s.path, "video file to write, for kind \"file\"");
  b.text("device", s.device,
         "for \"kms\" the card, e.g. /dev/dri/card0, \"auto\": the first with a monitor; for "
         "\"fbdev\" "
         "the framebuffer, \"auto\": /dev/fb0");
  b.text("connector", s.connector,
         "for \"kms\": the card's connector, e.g. HDMI-A-1; \"auto\": the first with a monitor");
  b.choice(
      "route", s.route, {"auto", "gpu", "cpu"},
      "for \"kms\": what lays the overlay over the picture; \"auto\": the display's own planes, "
      "with no driver of a graphics processor in the picture's way, else the processor; "
      "\"gpu\": the graphics processor, else the processor");
  b.text("mode", s.mode,
         "for \"kms\": WIDTHxHEIGHT or WIDTHxHEIGHT@HZ; \"auto\": the picture's own size and rate "
         "where the monitor has it");
  b.choice("registration", s.registration, {"lowest-latency", "exact"},
           "\"lowest-latency\" shows the picture at once, with the newest pose carried on to its "
           "time; \"exact\" lets it wait for the pose that is found in it");
  b.number("exact_wait", s.exact_wait, 0.1, 0.9,
           "[frame intervals] most that a picture waits for that");
}

void bindFootswitch(SettingBinder& b, FootswitchSettings& s) {
  b.section("footswitch");
  b.live(true);
  b.choice("action", s.action, {"reconstruct", "overlay-toggle", "snapshot"},
           "what a press of the pedal does");
  b.live(false);
  b.text("line", s.line,
         "GPIO line of a pedal, by name or, with a chip, by its offset; empty: none");
  b.text("chip", s.chip,
         "GPIO chip by path, name or label; empty: the line is looked for by name on all");
  b.choice("bias", s.bias, {"as-is", "disabled", "pull-up", "pull-down"},
           "resistor on the line, where the chip has one");
  b.flag("active_low", s.active_low, "the pedal pulls the line low");
  b.number("debounce_ms", s.debounce_ms, 0, 1000,
           "a level counts once it was steady for so long; by the kernel where it can");
  b.text("keyboard", s.keyboard,
         "USB pedal that is a keyboard, by path under /dev/input or name; empty: none");
  b.number("key", s.key, 0, 767, "its key, by number in linux/input-event-codes.h; 0: any");
}

void bindHeartbeat(SettingBinder& b, HeartbeatSettings& s) {
  b.section("heartbeat");
  b.text("line", s.line,
         "GPIO line that changes its level, 20 times a second at most, only while pictures go out, "
         "for a relay that bypasses the box; by name or, with a chip, by its offset; empty: none");
  b.text("chip", s.chip,
         "GPIO chip by path, name or label; empty: the line is looked for by name on all");
  b.flag("active_low", s.active_low, "the line starts high");
}

void bindDaemon(SettingBinder& b, DaemonSettings& s) {
  b.section("daemon");
  b.text("control_socket", s.control_socket, "where depthscope status and the like connect to");
  b.text("state_dir", s.state_dir, "folder for snapshots");
  b.text("ar_program", s.ar_program, "the AR process; empty: depthscope-ar beside depthscoped");
  b.number("realtime_priority", s.realtime_priority, 0, 99,
           "SCHED_FIFO priority of the video loop; 0: ordinary");
  b.flag("lock_memory", s.lock_memory, "keep all pages of the video process in memory");
  b.number("restart_min_s", s.restart_min_s, 0.01, 60,
           "first wait before the AR process is started again");
  b.number("restart_max_s", s.restart_max_s, 0.01, 600, "the wait doubles up to this");
  b.number("heartbeat_timeout_s", s.heartbeat_timeout_s, 0.5, 600,
           "an AR process silent for longer is killed and started again");
  b.number("ar_nice", s.ar_nice, 0, 19, "the AR process gives way to the picture: nice(2) value");
  b.number("ar_memory_mb", s.ar_memory_mb, 0, 1 << 20,
           "[MiB] private memory the AR process may take; 0: no limit");
  b.number("overlay_wait", s.overlay_wait, 0, 1,
           "[frame intervals] most that a picture waits for its overlay");
  b.number("stale_s", s.stale_s, 0, 60,
           "[s] the last picture stays for so long, marked, when no new one comes");
  b.text("frame_log", s.frame_log, "CSV file with the times of every picture; empty: none");
  b.number("max_vertices", s.max_vertices, 1000, 4000000, "room for a surface in shared memory");
  b.number("max_triangles", s.max_triangles, 1000, 8000000, "room for a surface in shared memory");
}

}  // namespace

std::vector<Setting> settingTable(Settings& settings) {
  SettingBinder binder;
  bindCapture(binder, settings.capture);
  bindSlam(binder, settings.slam);
  bindRecon(binder, settings.recon);
  bindOverlay(binder, settings.overlay);
  bindDisplay(binder, settings.display);
  bindFootswitch(binder, settings.footswitch);
  bindHeartbeat(binder, settings.heartbeat);
  bindDaemon(binder, settings.daemon);
  return binder.take();
}

}  // namespace depthscope::platform