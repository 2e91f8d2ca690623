#pragma once
#include <string>

#include "capture/v4l2_settings.hpp"
#include "overlay/overlay_settings.hpp"
#include "platform/footswitch/footswitch_settings.hpp"
#include "recon/recon_settings.hpp"
#include "slam/slam_settings.hpp"

namespace depthscope::platform {

/// Where the daemon's pictures come from: a capture card (card.device) or a clip (input).
struct CaptureSettings {
  capture::V4l2Settings card;  // its fps and buffers are those below
  std::string input;           // video file or folder of images
  std::string camera;          // camera file
  bool loop = true;    // play the clip again at its end; without it the daemon ends with the clip
  double fps = 0;      // [1/s] overrides the clip's rate; 0: the camera file's, else the clip's own
  int buffers = 8;     // pictures in the card's queue or the clip's pool
  std::string faults;  // fault script to act out; empty: none
};

enum class DisplayKind { Null, File, Kms, Fbdev };

/// Who lays the overlay over the picture on its way to a monitor. Auto: the display's own planes
/// where it has them, else the processor. Gpu: the graphics processor, else the processor.
enum class DisplayRoute { Auto, Gpu, Cpu };

/// How picture and overlay go together.
enum class Registration {
  LowestLatency,  // the picture at once, with the newest pose carried on to its time
  Exact,          // the picture waits, for a bounded time, for the pose found in it
};

/// Where the daemon's pictures go to.
struct DisplaySettings {
  DisplayKind kind = DisplayKind::Null;
  std::string path;                // video file to write, for kind "file"
  std::string device = "auto";     // card or framebuffer, e.g. /dev/dri/card0, /dev/fb0
  std::string connector = "auto";  // of the card, e.g. HDMI-A-1; auto: the first with a monitor
  DisplayRoute route = DisplayRoute::Auto;
  Registration registration = Registration::LowestLatency;
  double exact_wait = 0.8;    // most that a picture waits for its own pose, in frame intervals
  std::string mode = "auto";  // of the monitor, e.g. 1920x1080@60; auto: what fits the picture
};

/// A GPIO line that moves only while pictures go out, for a relay that bypasses the box.
struct HeartbeatSettings {
  std::string line;  // by name, or with `chip` by its offset; empty: none
  std::string chip;  // path, name or label; empty: the line is looked for by name on all chips
  bool active_low = false;
};

/// The daemon itself: control, supervision, priority.
struct DaemonSettings {
  std::string control_socket = "/run/depthscope/control.sock";
  std::string state_dir = "/var/lib/depthscope";  // snapshots go here
  std::string ar_program;           // the AR process; empty: depthscope-ar beside depthscoped
  int realtime_priority = 50;       // SCHED_FIFO priority of the video loop; 0: ordinary
  bool lock_memory = true;          // keep all pages of the video process in memory
  double restart_min_s = 0.2;       // first wait before the AR process is started again
  double restart_max_s = 10;        // the wait doubles up to this
  double heartbeat_timeout_s = 10;  // an AR process silent for longer is killed and started again
  int ar_nice = 10;                 // the AR process gives way to the picture: nice(2) value
  int ar_memory_mb = 1024;          // private memory the AR process may take; 0: no limit
  double overlay_wait = 0.5;        // most that a picture waits for its overlay, in frame intervals
  double stale_s = 1;         // the last picture stays for so long, marked, when no new one comes
  std::string frame_log;      // CSV file with the times of every picture; empty: none
  int max_vertices = 120000;  // room for a surface in shared memory
  int max_triangles = 240000;
};

/// Everything that can be configured, one struct a module, defaults in place.
struct Settings {
  CaptureSettings capture;
  slam::SlamSettings slam;
  recon::ReconSettings recon;
  overlay::OverlaySettings overlay;
  DisplaySettings display;
  FootswitchSettings footswitch;
  HeartbeatSettings heartbeat;
  DaemonSettings daemon;
};

}  // namespace depthscope::platform
