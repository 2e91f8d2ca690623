#include "slam/point_carrier.hpp"

#include <cmath>
#include <mutex>

#include "slam/optical_flow.hpp"

namespace depthscope::slam {

PointCarrier::PointCarrier(const CameraModel& camera, const SlamSettings& settings, Map& map,
                           const OrbExtractor& extractor)
    : camera_(camera),
      flow_sigma_px_(settings.tracker.flow_sigma_px),
      map_(map),
      extractor_(extractor),
      spare_(settings.extractor.capacity()) {
  missing_.reserve(settings.extractor.capacity());
  stamp_.resize(settings.capacity.map_points, 0);
}

int PointCarrier::carry(const TrackedFrame& last, TrackedFrame& frame) {
  collectMissing(last, frame);
  int carried = 0;
  spare_.collect(frame.features, [&](int f) { return frame.points[f].id == kNone; });
  for (const Carried& point : missing_) {
    const auto slot = spare_.slot(frame.features);
    if (!slot) break;
    if (!carry(point, last, frame, *slot)) continue;
    spare_.take(*slot);
    ++carried;
  }
  if (carried > 0) frame.features.grid.build(frame.features.keypoints);
  return carried;
}

void PointCarrier::collectMissing(const TrackedFrame& last, const TrackedFrame& frame) {
  missing_.clear();
  ++current_stamp_;
  const std::lock_guard lock(map_.mutex);
  for (int f = 0; f < frame.features.size(); ++f)
    if (const PointId p = map_.resolve(frame.points[f]); p != kNone) stamp_[p] = current_stamp_;
  for (int f = 0; f < last.features.size(); ++f) {
    const PointId p = map_.resolve(last.points[f]);
    if (p == kNone || stamp_[p] == current_stamp_) continue;
    stamp_[p] = current_stamp_;
    missing_.push_back({map_.ref(p), map_.point(p).position, f});
  }
}

bool PointCarrier::carry(const Carried& point, const TrackedFrame& last, TrackedFrame& frame,
                         int slot) const {
  const Eigen::Vector3d p = frame.T_camera_world * point.position;
  if (p.z() < kMinDepth) return false;
  const Keypoint& before = last.features.keypoints[point.feature];
  const auto place = followPatch(extractor_.pictureBefore(), extractor_.lastPicture(),
                                 {before.x, before.y}, before.octave, camera_.project(p));
  if (!place || !extractor_.describe(*place, before.octave, frame.features, slot)) return false;
  // Each step adds its own error.
  Keypoint& now = frame.features.keypoints[slot];
  const double step = flow_sigma_px_ * extractor_.scaleFactors()[before.octave];
  now.sigma = static_cast<float>(std::hypot(before.sigma, step));
  frame.points[slot] = point.ref;
  return true;
}

}  // namespace depthscope::slam
