#pragma once
#include <cstdint>
#include <vector>

#include "platform/ar/ar_options.hpp"
#include "platform/ar/live_slam.hpp"
#include "platform/ipc/frame_ring.hpp"
#include "platform/ipc/surface_mailbox.hpp"
#include "platform/label_board.hpp"

namespace depthscope::platform {

/// The AR process: takes the newest picture out of the shared memory, tracks it, and publishes
/// pose, surface, labels and a heartbeat, until the video process closes the command socket.
class ArProcess {
 public:
  /// Throws InputError when the shared memory does not fit the camera.
  explicit ArProcess(ArOptions options);
  void run();

 private:
  bool handleCommands();
  void handlePicture();
  void reset();
  void publishSurface();
  void publishView();
  void publishLabels();
  void publishStatus();

  ArOptions options_;
  SharedMemory memory_;
  FrameRingReader frames_;
  SurfaceMailboxWriter surfaces_;
  LiveSlam live_;
  ViewOutline view_;
  LabelBoard labels_;
  SurfaceMesh surface_;
  PoseEstimate estimate_;
  WireFrameInfo picture_info_{};
  std::vector<std::uint8_t> picture_;
  std::vector<Rgb> color_;
  Histogram track_ms_;
  WireArStatus status_{};
};

}  // namespace depthscope::platform
