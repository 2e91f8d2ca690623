#pragma once
#include <chrono>
#include <string>
#include <string_view>

#include "platform/config/settings.hpp"
#include "platform/daemon/ar_supervisor.hpp"
#include "platform/daemon/map_scale_keeper.hpp"
#include "platform/daemon/video_report.hpp"
#include "platform/daemon/video_requests.hpp"
#include "platform/footswitch/footswitch.hpp"

namespace depthscope::platform {

/// Carries out what comes in on the control socket. All references outlive it. From the service's
/// thread.
class ControlRequests {
 public:
  ControlRequests(Settings& settings, const CameraModel& camera, const SharedMemory& memory,
                  ArSupervisor& ar, VideoRequests& video, const VideoReport& report,
                  const Footswitch& footswitch, MapScaleKeeper& scale);

  /// "ok", "ok TEXT" or "error WHY".
  std::string handle(std::string_view line, UniqueFd attached);
  /// Does what the settings have the footswitch do; answers like handle().
  std::string footswitchPressed();

 private:
  std::string status() const;
  std::string command(const WireCommand& command);
  std::string reset();
  std::string label(std::string_view text, const Eigen::Vector2d& pixel);
  std::string labelAt(std::string_view rest);
  std::string overlay(std::string_view mode);
  std::string snapshot();
  std::string scale(std::string_view rest);
  std::string exportSurface(std::string_view format, UniqueFd file) const;

  Settings& settings_;  // the overlay's are changed on request
  CameraModel camera_;
  const SharedMemory& memory_;
  ArSupervisor& ar_;
  VideoRequests& video_;
  const VideoReport& report_;
  const Footswitch& footswitch_;
  MapScaleKeeper& scale_;
  overlay::CueMode shown_cue_ =
      overlay::CueMode::Chromadepth;  // what "overlay toggle" goes back to
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace depthscope::platform
