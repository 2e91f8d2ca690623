#include "overlay/lens.hpp"

#include <cmath>
#include <numbers>

namespace depthscope::overlay {
namespace {

constexpr double kMinSlope =
    0.1;  // of distorted over undistorted radius: flatter is as good as folded

/// Derivative of the distorted radius by the undistorted one (pinhole) or by the angle (fisheye).
double slope(const CameraModel& c, double x) {
  const double x2 = x * x;
  if (c.kind == CameraModel::Kind::Fisheye)
    return 1 + x2 * (3 * c.k[0] + x2 * (5 * c.k[1] + x2 * (7 * c.k[2] + x2 * 9 * c.k[3])));
  return 1 + x2 * (3 * c.k[0] + x2 * (5 * c.k[1] + x2 * 7 * c.k[4]));
}

}  // namespace

double validRadius(const CameraModel& camera) {
  const double max_angle = 85 * std::numbers::pi / 180;
  for (double angle = 0; angle < max_angle; angle += 1e-3) {
    const double x = camera.kind == CameraModel::Kind::Fisheye ? angle : std::tan(angle);
    if (slope(camera, x) < kMinSlope) return std::tan(angle);
  }
  return std::tan(max_angle);
}

}  // namespace depthscope::overlay
