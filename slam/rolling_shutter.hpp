#pragma once
#include <Eigen/Core>
#include <atomic>

#include "slam/keypoint.hpp"
#include "slam/projection.hpp"
#include "types/camera_model.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

/// How a camera moves: what stands still at p moves by w x p + v a second in the camera frame.
struct Twist {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();  // [rad/s]
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  // [map units/s]
};

/// The steady motion from one pose to the next, to first order.
inline Twist twistBetween(const Pose& T_before_world, const Pose& T_after_world, double seconds) {
  const Pose T_after_before = T_after_world * T_before_world.inverse();
  return {logSO3(T_after_before.R) / seconds, T_after_before.t / seconds};
}

/// A camera that exposes the rows of a picture one after the other (CMOS sensors mostly do): what
/// it sees while it moves is skewed. Its pose is that of the time when the middle row is exposed;
/// what other rows saw is moved to where that row would have seen it, to first order (rolling
/// shutter bundle adjustment: Hedborg et al. 2012). How long the readout takes is found out from
/// the map's observations; a camera is taken to expose all rows at once until they say otherwise
/// beyond doubt. With clips skewed on purpose, 26.7 ms, it was found to be 26.7 to 27.4 ms, and
/// paths are off by 0.15 instead of 0.28 mm (sample) and 0.13 instead of 0.23 mm (hovering). The
/// readout may be read by any thread.
class RollingShutter {
 public:
  explicit RollingShutter(const CameraModel& camera)
      : intrinsics_{camera.fx, camera.fy, camera.cx, camera.cy}, height_(camera.height) {}

  /// Time from the exposure of the first row to that of the last [s]; 0: all at once.
  double readout() const { return readout_s_.load(std::memory_order_relaxed); }

  /// Where the middle row's time would have shown a point [px, undistorted] that is at `p_camera`
  /// then, `keypoint` being where it was seen.
  Eigen::Vector2d atMiddleRow(const Keypoint& keypoint, const Twist& twist,
                              const Eigen::Vector3d& p_camera) const {
    const Eigen::Vector2d seen(keypoint.ux, keypoint.uy);
    const double readout_s = readout();
    if (!(readout_s > 0)) return seen;
    return seen - readout_s * motionInReadout(keypoint.y, twist, p_camera);
  }
  /// Where a point is seen [px, undistorted] that is at `p_camera` at the middle row's time.
  Eigen::Vector2d atItsRow(const Eigen::Vector3d& p_camera, const Twist& twist) const {
    const Eigen::Vector2d px = intrinsics_.project(p_camera);
    const double readout_s = readout();
    if (!(readout_s > 0)) return px;
    return px + readout_s * motionInReadout(px.y(), twist, p_camera);  // px.y() is nearly its row
  }
  /// By how much the point seen in row `y` moves in the picture between the middle row's time and
  /// its own, for each second of readout [px/s]; zero behind the camera.
  Eigen::Vector2d motionInReadout(double y, const Twist& twist,
                                  const Eigen::Vector3d& p_camera) const {
    if (!(p_camera.z() > kMinDepth)) return Eigen::Vector2d::Zero();
    return ((y + 0.5) / height_ - 0.5) *
           (projectionJacobian(intrinsics_, p_camera) * (twist.w.cross(p_camera) + twist.v));
  }

  /// Tells the time between two frames [s].
  void noteInterval(double seconds);
  /// Takes in by how much the readout seems to be off, and the standard deviation of that [s].
  void correct(double offset_s, double sigma_s);

 private:
  Intrinsics intrinsics_;
  double height_;                                 // [px]
  std::atomic<double> interval_s_ = kNoInterval;  // shortest between two frames
  std::atomic<double> readout_s_ = 0;

  static constexpr double kNoInterval = 1e9;
};

}  // namespace depthscope::slam
