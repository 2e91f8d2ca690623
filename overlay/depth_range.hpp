#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "types/camera_model.hpp"
#include "types/pose.hpp"

namespace depthscope::overlay {

/// The span of depths the colours stand for: the bulk of what is in view, moving too slowly to
/// flicker.
class DepthRange {
 public:
  static constexpr int kSamples = 1024;

  DepthRange();
  /// `points`: of the surface, its own frame; `T_camera_surface` takes them to the camera. `dt_s`:
  /// time since the call before, negative: unknown. Without easing (first call, unknown time) the
  /// new range is taken as it is.
  void update(std::span<const Eigen::Vector3f> points, const Pose& T_camera_surface,
              const CameraModel& camera, double dt_s);
  void reset() { valid_ = false; }

  bool valid() const { return valid_; }  // false: nothing of the surface was ever in view
  float nearDepth() const { return near_; }
  float farDepth() const { return far_; }

 private:
  bool valid_ = false;
  float near_ = 0, far_ = 1;
  std::vector<float> depths_;
};

}  // namespace depthscope::overlay
