#pragma once
#include <mutex>
#include <optional>
#include <vector>

#include "platform/ar/steady_view.hpp"
#include "platform/histogram.hpp"
#include "platform/surface_schedule.hpp"
#include "recon/reconstruction_worker.hpp"
#include "slam/slam_system.hpp"

namespace depthscope::platform {

/// SLAM and reconstruction as they run live: tracking in the caller's thread, mapping and
/// reconstruction in threads of their own; a new surface is asked for every period or on demand.
class LiveSlam {
 public:
  /// Makes no surfaces where `recon` is null.
  LiveSlam(const CameraModel& camera, const slam::SlamSettings& slam,
           const recon::ReconSettings* recon);

  /// Tracks one picture and asks for a surface when one is due; `color` is for surfaces (see
  /// ColorReduction). From one thread.
  PoseEstimate track(const GrayView& luma, const RgbView& color, std::int64_t frame,
                     double timestamp_s);
  /// The next tracked frame asks for a surface. From the tracking thread.
  void requestSurface() { surface_wanted_ = true; }
  /// A new surface this often [s], from now on; 0: on demand only. From the tracking thread.
  void setSurfacePeriod(double period_s) { schedule_ = SurfaceSchedule(period_s); }
  /// Swaps the newest surface into `mesh` if there is a new one, of the active map.
  bool takeSurface(SurfaceMesh& mesh);
  /// The view of the scope, if it has changed since the last call. From the tracking thread.
  bool takeView(ViewOutline& view);
  /// Forgets everything and starts over. From the tracking thread.
  void reset();

  /// Ends reconstruction in the background and hands out what it worked with, null where no
  /// surfaces are made. Nothing may be tracked after it.
  recon::Reconstructor* finishReconstruction() { return worker_ ? &worker_->finish() : nullptr; }

  const slam::SlamSystem& slam() const { return slam_; }
  /// Times of the surfaces made so far [ms].
  Histogram reconstructTimes() const;

 private:
  void requestWhenDue(const PoseEstimate& estimate);
  /// Called in the thread that reconstructs.
  void reconstructed(const recon::ReconReport& report);

  slam::SlamSystem slam_;
  SurfaceSchedule schedule_;
  bool surface_wanted_ = false;
  std::uint32_t map_id_ = 0;
  SteadyView view_;
  bool view_changed_ = false;
  SparseCloud cloud_;
  mutable std::mutex times_mutex_;
  Histogram reconstruct_ms_;                           // guarded by times_mutex_
  std::optional<recon::ReconstructionWorker> worker_;  // last: its thread uses what stands above
};

}  // namespace depthscope::platform
