#include "overlay/depth_range.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::overlay {
namespace {

// Time constant: slow enough not to flicker, quick enough that a scope drawn back at some
// centimetres a second does not leave the whole view beyond the far end of the colours.
constexpr double kEasing_s = 0.35;
constexpr std::size_t kTail = 33;      // one in so many is ignored at either end
constexpr std::size_t kMinInView = 4;  // fewer say nothing about the range
constexpr float kMinSpan =
    0.15f;  // of the mean depth, so that a flat wall is not painted in all colours

}  // namespace

DepthRange::DepthRange() {
  depths_.reserve(kSamples);
}

void DepthRange::update(std::span<const Eigen::Vector3f> points, const Pose& T_camera_surface,
                        const CameraModel& camera, double dt_s) {
  const Eigen::Matrix3f R = T_camera_surface.R.cast<float>();
  const Eigen::Vector3f t = T_camera_surface.t.cast<float>();
  // The undistorted field of view is close enough to choose samples by.
  const float half_w = static_cast<float>(0.55 * camera.width / camera.fx);
  const float half_h = static_cast<float>(0.55 * camera.height / camera.fy);
  depths_.clear();
  const std::size_t step = std::max<std::size_t>(1, (points.size() + kSamples - 1) / kSamples);
  for (std::size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector3f p = R * points[i] + t;
    if (p.z() > 0 && std::abs(p.x()) < half_w * p.z() && std::abs(p.y()) < half_h * p.z())
      depths_.push_back(p.z());
  }
  if (depths_.size() < kMinInView) return;

  const auto low = depths_.begin() + static_cast<std::ptrdiff_t>(depths_.size() / kTail);
  const auto high = depths_.end() - 1 - static_cast<std::ptrdiff_t>(depths_.size() / kTail);
  std::nth_element(depths_.begin(), low, depths_.end());
  const float near_now = *low;
  std::nth_element(depths_.begin(), high, depths_.end());
  const float far_now = *high;
  const float middle = 0.5f * (near_now + far_now);
  const float half_span = std::max(0.5f * (far_now - near_now), 0.5f * kMinSpan * middle);

  const bool ease = valid_ && dt_s >= 0;
  const float k = ease ? static_cast<float>(1 - std::exp(-dt_s / kEasing_s)) : 1.0f;
  near_ = valid_ ? near_ + k * (middle - half_span - near_) : middle - half_span;
  far_ = valid_ ? far_ + k * (middle + half_span - far_) : middle + half_span;
  valid_ = true;
}

}  // namespace depthscope::overlay
