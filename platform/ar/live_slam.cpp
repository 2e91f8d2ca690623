#include "platform/ar/live_slam.hpp"

#include <utility>

#include "platform/ar/surface_log.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::platform {

LiveSlam::LiveSlam(const CameraModel& camera, const slam::SlamSettings& slam,
                   const recon::ReconSettings* recon)
    : slam_(camera, slam, slam::MappingMode::Threaded),
      schedule_(recon == nullptr ? 0 : recon->period_s) {
  if (recon == nullptr) return;
  cloud_.points.reserve(static_cast<std::size_t>(slam.capacity.map_points));
  const auto views = static_cast<std::size_t>(slam.capacity.keyframes + slam.capacity.views);
  cloud_.views_T_camera_world.reserve(views);
  cloud_.view_frames.reserve(views);
  worker_.emplace(camera, *recon,
                  [this](const recon::ReconReport& report) { reconstructed(report); });
}

void LiveSlam::reconstructed(const recon::ReconReport& report) {
  logReconstruction(report.status, report.points, report.change);
  if (report.status != recon::ReconStatus::Ok) return;
  const std::lock_guard lock(times_mutex_);
  reconstruct_ms_.add(report.duration_ms);
}

PoseEstimate LiveSlam::track(const GrayView& luma, const RgbView& color, std::int64_t frame,
                             double timestamp_s) {
  PoseEstimate estimate;
  {
    const AllocationScope counted;
    estimate = slam_.track(luma, frame, timestamp_s);
    view_changed_ |= view_.add(slam_.view(), estimate);
    if (worker_ && slam_.wantsPicture()) worker_->addPicture(luma, color, frame);
  }
  if (estimate.map_id != map_id_) {
    if (worker_) worker_->cancel();
    map_id_ = estimate.map_id;
    schedule_.restart();
  }
  if (worker_ && estimate.state == TrackingState::Tracking) requestWhenDue(estimate);
  return estimate;
}

void LiveSlam::requestWhenDue(const PoseEstimate& estimate) {
  const bool due = schedule_.due(estimate.timestamp_s);
  if (!due && !surface_wanted_) return;
  slam_.copyCloud(cloud_);
  if (!worker_->request(cloud_)) return;  // busy with the exchange: the next frame asks again
  surface_wanted_ = false;
  schedule_.surfaceRequested(estimate.timestamp_s);
}

bool LiveSlam::takeSurface(SurfaceMesh& mesh) {
  return worker_ && worker_->takeNewest(mesh) && mesh.map_id == map_id_;
}

bool LiveSlam::takeView(ViewOutline& view) {
  if (!std::exchange(view_changed_, false)) return false;
  view = view_.view();
  return true;
}

void LiveSlam::reset() {
  if (worker_) worker_->cancel();
  slam_.reset();
  view_.reset();
  schedule_.restart();
}

Histogram LiveSlam::reconstructTimes() const {
  const std::lock_guard lock(times_mutex_);
  return reconstruct_ms_;
}

}  // namespace depthscope::platform
