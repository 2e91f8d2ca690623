#pragma once
#include <memory>

#include "capture/frame_source.hpp"
#include "platform/daemon/ar_link.hpp"
#include "platform/daemon/ar_supervisor.hpp"
#include "platform/daemon/control_requests.hpp"
#include "platform/daemon/control_server.hpp"
#include "platform/daemon/daemon_options.hpp"
#include "platform/daemon/frame_log.hpp"
#include "platform/daemon/life_signs.hpp"
#include "platform/daemon/overlay_thread.hpp"
#include "platform/daemon/video_thread.hpp"
#include "platform/display/display.hpp"
#include "platform/footswitch/footswitch.hpp"
#include "platform/log_thread.hpp"

namespace depthscope::platform {

/// The video process: the video loop and the drawing of the overlay in threads of their own, and
/// beside them, in the calling thread, the service: signals, the AR process, the control socket,
/// systemd.
class Daemon {
 public:
  /// Blocks the signals that the service waits for, so it comes before any thread. Throws
  /// InputError and std::system_error.
  explicit Daemon(const DaemonOptions& options);
  /// Until a signal or the clip's end. Throws what ended the video loop, if something did.
  void run();

 private:
  void serviceLoop();
  std::unique_ptr<VideoLoop> makeLoop(LayerSource& layers);
  bool handleSignals();
  void serveFootswitch(std::span<const pollfd> descriptors);
  void reload();
  void logSource();
  void logEnd() const;

  const DaemonOptions options_;
  Settings settings_;     // those in force: the options', as changed since
  UniqueFd signals_;      // before any thread
  LogThread log_thread_;  // outlives all that log
  std::unique_ptr<capture::FrameSource> source_;
  double fps_;
  SharedMemory memory_;
  std::unique_ptr<Display> display_;
  ArLink link_;
  PoseWait pose_wait_;
  ArSupervisor ar_;
  VideoReport report_;
  VideoRequests video_requests_;
  std::optional<FrameLog> frame_log_;
  std::unique_ptr<GpioChips> gpio_;
  Footswitch footswitch_;
  MapScaleKeeper scale_;
  int ar_restarts_ = 0;  // that the scale knows of
  ControlRequests control_requests_;
  ControlServer control_;
};

}  // namespace depthscope::platform
