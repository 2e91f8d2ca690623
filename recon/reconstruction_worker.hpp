#pragma once
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "recon/picture_inbox.hpp"
#include "recon/reconstructor.hpp"

namespace depthscope::recon {

/// How one reconstruction went.
struct ReconReport {
  ReconStatus status = ReconStatus::Ok;
  double duration_ms = 0;  // monotonic clock: work since the last one, pictures included
  std::uint32_t map_id = 0;
  std::size_t points = 0;     // in the cloud
  std::size_t triangles = 0;  // in the mesh; 0 unless Ok
  SurfaceChange change;       // from the surface before; see Reconstructor::lastChange()
};

/// Reconstructs on a thread of its own at low priority. Requests and meshes are exchanged by a swap
/// under a lock that callers only ever try: tracking never waits for reconstruction. Only the
/// newest request and the newest mesh count. No exception leaves the thread.
class ReconstructionWorker {
 public:
  using Listener = std::function<void(const ReconReport&)>;

  /// `on_finished`, if any, is called on the worker's thread after every reconstruction; it must
  /// not throw.
  ReconstructionWorker(const CameraModel& camera, const ReconSettings& settings,
                       Listener on_finished = {});
  /// Cancels what is running and joins.
  ~ReconstructionWorker();
  ReconstructionWorker(const ReconstructionWorker&) = delete;
  ReconstructionWorker& operator=(const ReconstructionWorker&) = delete;

  /// Hands over the picture of a view, with its small colour picture (see ColorReduction); it
  /// is copied, reduced. Neither waits nor allocates. False when so many wait that there is no
  /// room. From one thread.
  bool addPicture(const GrayView& luma, const RgbView& color, std::int64_t frame);
  /// Swaps `cloud` with the waiting request (whose storage comes back for reuse) and wakes the
  /// worker. False, and `cloud` as it was, in the rare case that the worker is at the exchange
  /// itself: ask again later.
  bool request(SparseCloud& cloud);

  /// Swaps the newest mesh into `mesh` if there is one that was not taken yet.
  bool takeNewest(SurfaceMesh& mesh);

  /// Cancels the reconstruction that runs and drops the waiting request, as after a reset of the
  /// map. Its mesh may still come when it was already done: compare `map_id`.
  void cancel();
  /// Ends the thread, what it does included, and hands out what it worked with, all pictures taken
  /// in. Nothing else may be called after it.
  Reconstructor& finish();

 private:
  void loop(const std::stop_token& stop);
  void takePictures();
  void deliver(ReconStatus status, double duration_ms);

  Reconstructor reconstructor_;
  PictureInbox inbox_;
  double pictures_ms_ = 0;  // spent on them since the last surface
  Listener on_finished_;

  std::mutex mutex_;  // guards what follows, held for swaps only
  std::condition_variable_any wake_;
  SparseCloud waiting_;
  bool has_waiting_ = false;
  SurfaceMesh newest_;
  bool has_newest_ = false;
  std::stop_source running_;  // of the reconstruction that runs

  SparseCloud cloud_;  // the worker's own
  SurfaceMesh mesh_;   // the worker's own
  std::jthread thread_;
};

}  // namespace depthscope::recon
