#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "slam/intrinsics.hpp"
#include "types/pose.hpp"

namespace depthscope::slam::testing {

/// Geometry with known answers. Every function is a pure function of its seed.

inline constexpr double kWidth_px = 640, kHeight_px = 480;
inline constexpr double kRadians = std::numbers::pi / 180;

inline Intrinsics testCamera() {
  return {500, 510, 322, 238};
}

inline double uniform(std::mt19937& rng, double low, double high) {
  return low + (high - low) * (static_cast<double>(rng()) / 4294967296.0);
}

inline Eigen::Vector2d gaussian2(std::mt19937& rng, double sigma) {
  const double r = sigma * std::sqrt(-2 * std::log(1 - uniform(rng, 0, 1)));
  const double a = 2 * std::numbers::pi * uniform(rng, 0, 1);
  return {r * std::cos(a), r * std::sin(a)};
}

inline Eigen::Vector2d randomPixel(std::mt19937& rng, double margin_px = 0) {
  return {uniform(rng, margin_px, kWidth_px - margin_px),
          uniform(rng, margin_px, kHeight_px - margin_px)};
}

/// Points all over the picture of a camera at the origin, depths between near and far.
inline std::vector<Eigen::Vector3d> volumePoints(int n, unsigned seed, double near, double far) {
  std::mt19937 rng(seed);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d ray = testCamera().normalize(randomPixel(rng, 20)).homogeneous();
    points.push_back(uniform(rng, near, far) * ray);
  }
  return points;
}

/// Points on the plane normal . p = distance (camera frame at the origin), all over the picture.
inline std::vector<Eigen::Vector3d> planePoints(int n, unsigned seed, const Eigen::Vector3d& normal,
                                                double distance) {
  std::mt19937 rng(seed);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d ray = testCamera().normalize(randomPixel(rng, 20)).homogeneous();
    points.push_back(distance / normal.dot(ray) * ray);
  }
  return points;
}

/// T_camera_world of a camera with its centre at `centre` (world), turned by the rotation vector
/// `rotation` [rad].
inline Pose cameraAt(const Eigen::Vector3d& centre, const Eigen::Vector3d& rotation) {
  Pose T_world_camera{expSO3(rotation), centre};
  return T_world_camera.inverse();
}

/// Normal of a plane that fits no axis.
inline const Eigen::Vector3d kTilted = Eigen::Vector3d(0.3, -0.2, 1).normalized();

struct Matches {
  std::vector<Eigen::Vector2f> first, second;
  std::vector<std::uint8_t> correct;
};

/// Projections of points (first camera's frame) into both views, of which a share is replaced by
/// nonsense.
inline Matches project(const std::vector<Eigen::Vector3d>& points, const Pose& T_second_first,
                       double noise_px, double outlier_share, unsigned seed) {
  std::mt19937 rng(seed);
  Matches m;
  for (const auto& p : points) {
    const bool outlier = uniform(rng, 0, 1) < outlier_share;
    const Eigen::Vector2d a = testCamera().project(p) + gaussian2(rng, noise_px);
    const Eigen::Vector2d b =
        outlier
            ? randomPixel(rng)
            : Eigen::Vector2d(testCamera().project(T_second_first * p) + gaussian2(rng, noise_px));
    m.first.push_back(a.cast<float>());
    m.second.push_back(b.cast<float>());
    m.correct.push_back(!outlier);
  }
  return m;
}

inline double rotationError(const Pose& a, const Pose& b) {
  return logSO3(a.R * b.R.transpose()).norm();
}

}  // namespace depthscope::slam::testing
