#include "slam/undistortion_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kStep = 8;             // [px] between nodes
constexpr double kTolerance = 0.01;  // [px] of the captured picture

}  // namespace

UndistortionMap::UndistortionMap(const CameraModel& camera) : camera_(camera) {
  if (!camera.hasDistortion()) return;
  columns_ = camera.width / kStep + 2;
  rows_ = camera.height / kStep + 2;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      nodes_.push_back(camera.toPixel(camera.unproject(Eigen::Vector2d(c * kStep, r * kStep))));
}

Eigen::Vector2d UndistortionMap::distortPixel(const Eigen::Vector2d& undistorted) const {
  const Eigen::Vector2d n((undistorted.x() - camera_.cx) / camera_.fx,
                          (undistorted.y() - camera_.cy) / camera_.fy);
  return camera_.toPixel(camera_.distort(n));
}

std::optional<UndistortionMap::Point> UndistortionMap::operator()(
    const Eigen::Vector2d& captured) const {
  if (nodes_.empty()) return Point{captured, 1};
  const Eigen::Vector2d grid = captured / kStep;
  const int c = std::clamp(static_cast<int>(grid.x()), 0, columns_ - 2);
  const int r = std::clamp(static_cast<int>(grid.y()), 0, rows_ - 2);
  const double a = grid.x() - c, b = grid.y() - r;
  const Eigen::Vector2d* upper = nodes_.data() + r * columns_ + c;
  const Eigen::Vector2d* lower = upper + columns_;
  Eigen::Matrix2d J;  // d undistorted / d captured
  J.col(0) = ((1 - b) * (upper[1] - upper[0]) + b * (lower[1] - lower[0])) / kStep;
  J.col(1) = ((1 - a) * (lower[0] - upper[0]) + a * (lower[1] - upper[1])) / kStep;
  const double area = J.determinant();
  if (!(area > 0)) return std::nullopt;

  Eigen::Vector2d u =
      (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
  u += J * (captured - distortPixel(u));
  if (!((captured - distortPixel(u)).squaredNorm() < kTolerance * kTolerance)) {
    u = camera_.toPixel(camera_.unproject(captured));
    if (!((captured - distortPixel(u)).squaredNorm() < kTolerance * kTolerance))
      return std::nullopt;
  }
  return Point{u, std::sqrt(area)};
}

}  // namespace depthscope::slam
