#pragma once
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "platform/ar/live_slam.hpp"
#include "platform/replay/run_record.hpp"

namespace depthscope::platform {

/// Tracks in a thread of its own; a picture that is offered while one is tracked replaces the one
/// that waits (newest frame wins).
class TrackingThread {
 public:
  TrackingThread(const CameraModel& camera, const slam::SlamSettings& slam,
                 const recon::ReconSettings* recon, std::int64_t expected_frames);
  ~TrackingThread();

  /// Copies the picture; `color` is its small colour picture (see ColorReduction). Throws what
  /// stopped the thread, if something did.
  void offer(const GrayView& luma, const RgbView& color, std::int64_t frame, double timestamp_s);
  /// What is known after the newest tracked picture.
  PoseEstimate newest() const;
  /// Swaps the newest surface into `mesh` if there is a new one.
  bool takeSurface(SurfaceMesh& mesh);
  /// The view of the scope, if it has changed since the last call.
  bool takeView(ViewOutline& view);
  /// Tracks what waits and ends the thread. Throws like offer().
  void stop();

  /// After stop() only.
  RunRecord& record() { return record_; }
  LiveSlam& live() { return live_; }

 private:
  struct Picture {
    std::vector<std::uint8_t> pixels;
    std::vector<Rgb> color;
    std::int64_t frame = -1;
    double timestamp_s = 0;
  };
  void run();
  void loop();

  int width_, height_;
  ColorReduction color_size_;
  LiveSlam live_;
  RunRecord record_;
  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  Picture waiting_;
  bool has_waiting_ = false, stopping_ = false;
  PoseEstimate newest_;
  SurfaceMesh surface_;
  bool has_surface_ = false;
  ViewOutline view_;
  bool has_view_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace depthscope::platform
