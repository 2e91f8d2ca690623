#include "recon/reconstruction_worker.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <utility>

namespace depthscope::recon {
namespace {

constexpr int kNice = 10;  // added to the nice value that tracking has: well below it

/// On Linux a thread has its own nice value, and those that it starts inherit it. Failure leaves
/// the priority as it is, which is harmless.
void lowerPriority() {
  const auto self = static_cast<id_t>(::gettid());
  (void)::setpriority(PRIO_PROCESS, self, ::getpriority(PRIO_PROCESS, self) + kNice);
}

}  // namespace

ReconstructionWorker::ReconstructionWorker(const CameraModel& camera, const ReconSettings& settings,
                                           Listener on_finished)
    : reconstructor_(camera, settings),
      inbox_(camera.width, camera.height, reconstructor_.pictureReduction()),
      on_finished_(std::move(on_finished)),
      thread_([this](const std::stop_token& stop) { loop(stop); }) {}

ReconstructionWorker::~ReconstructionWorker() {
  thread_.request_stop();
  cancel();
}

bool ReconstructionWorker::addPicture(const GrayView& luma, const RgbView& color,
                                      std::int64_t frame) {
  if (!inbox_.put(luma, color, frame)) return false;
  // The lock is not taken: a wake-up that comes between the worker's look at the inbox and its
  // sleep is made up for by the next.
  wake_.notify_one();
  return true;
}

bool ReconstructionWorker::request(SparseCloud& cloud) {
  {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return false;
    std::swap(waiting_, cloud);
    has_waiting_ = true;
  }
  wake_.notify_one();
  return true;
}

bool ReconstructionWorker::takeNewest(SurfaceMesh& mesh) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || !has_newest_) return false;
  std::swap(newest_, mesh);
  has_newest_ = false;
  return true;
}

void ReconstructionWorker::cancel() {
  const std::lock_guard lock(mutex_);
  has_waiting_ = false;
  running_.request_stop();
}

Reconstructor& ReconstructionWorker::finish() {
  thread_.request_stop();
  cancel();
  if (thread_.joinable()) thread_.join();
  takePictures();
  return reconstructor_;
}

void ReconstructionWorker::takePictures() {
  if (!inbox_.waiting()) return;
  const auto start = std::chrono::steady_clock::now();
  for (; inbox_.waiting(); inbox_.pop()) reconstructor_.addPicture(inbox_.front());
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  pictures_ms_ += took.count();
}

void ReconstructionWorker::loop(const std::stop_token& stop) {
  lowerPriority();
  for (;;) {
    std::stop_token running;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [this] { return has_waiting_ || inbox_.waiting(); })) return;
      if (!has_waiting_) {
        lock.unlock();
        takePictures();
        continue;
      }
      std::swap(cloud_, waiting_);
      has_waiting_ = false;
      if (running_.stop_requested()) running_ = std::stop_source();
      running = running_.get_token();
    }
    takePictures();
    const auto start = std::chrono::steady_clock::now();
    const ReconStatus status = reconstructor_.reconstruct(cloud_, mesh_, running);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    deliver(status, took.count() + std::exchange(pictures_ms_, 0));
  }
}

void ReconstructionWorker::deliver(ReconStatus status, double duration_ms) {
  const bool ok = status == ReconStatus::Ok;
  const ReconReport report{status,
                           duration_ms,
                           cloud_.map_id,
                           cloud_.points.size(),
                           ok ? mesh_.triangles.size() : 0,
                           ok ? reconstructor_.lastChange() : SurfaceChange{}};
  if (ok) {
    const std::lock_guard lock(mutex_);
    std::swap(newest_, mesh_);
    has_newest_ = true;
  }
  if (on_finished_) on_finished_(report);
}

}  // namespace depthscope::recon
