#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace depthscope {

/// Intrinsics and lens distortion of one camera, in pixels of an image of width x height; the
/// centre of the top left pixel is (0, 0). As in OpenCV: `Pinhole` is Brown-Conrady with k1 k2 p1
/// p2 k3, `Fisheye` is Kannala-Brandt with k1 k2 k3 k4.
struct CameraModel {
  enum class Kind { Pinhole, Fisheye };

  Kind kind = Kind::Pinhole;
  int width = 0;                          // [px]
  int height = 0;                         // [px]
  double fps = 0;                         // [1/s], 0: unknown
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]
  std::array<double, 5> k{};              // Pinhole: k1 k2 p1 p2 k3; Fisheye: k1 k2 k3 k4, unused

  bool hasDistortion() const {
    for (double c : k)
      if (c != 0) return true;
    return kind == Kind::Fisheye;
  }

  /// Undistorted, normalized image coordinates (x/z, y/z) -> distorted normalized coordinates.
  Eigen::Vector2d distort(const Eigen::Vector2d& n) const {
    const double r2 = n.squaredNorm();
    if (kind == Kind::Fisheye) {
      const double r = std::sqrt(r2);
      if (r < 1e-9) return n;
      const double th = std::atan(r), t2 = th * th;
      const double thd = th * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
      return n * (thd / r);
    }
    const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
    const double xy2 = 2 * n.x() * n.y();
    return {n.x() * radial + k[2] * xy2 + k[3] * (r2 + 2 * n.x() * n.x()),
            n.y() * radial + k[2] * (r2 + 2 * n.y() * n.y()) + k[3] * xy2};
  }

  /// Inverse of `distort`, by Newton's method with a numerical Jacobian; accurate to 1e-9 wherever
  /// the distortion is one to one, else the nearest it came to.
  Eigen::Vector2d undistort(const Eigen::Vector2d& d) const {
    if (!hasDistortion()) return d;
    if (kind == Kind::Fisheye) return undistortFisheye(d);
    Eigen::Vector2d n = d;
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector2d e = d - distort(n);
      constexpr double h = 1e-6;
      const Eigen::Vector2d dx =
          (distort(n + Eigen::Vector2d(h, 0)) - distort(n - Eigen::Vector2d(h, 0))) / (2 * h);
      const Eigen::Vector2d dy =
          (distort(n + Eigen::Vector2d(0, h)) - distort(n - Eigen::Vector2d(0, h))) / (2 * h);
      const double det = dx.x() * dy.y() - dy.x() * dx.y();
      if (det < 1e-3) {  // the lens folds over here: step back towards the centre
        n *= 0.8;
        continue;
      }
      n += Eigen::Vector2d(dy.y() * e.x() - dy.x() * e.y(), -dx.y() * e.x() + dx.x() * e.y()) / det;
      if (e.squaredNorm() < 1e-24) break;
    }
    return n;
  }

  /// Point in the camera frame (z > 0) -> pixel in the picture as captured, distortion included.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return toPixel(distort(p.head<2>() / p.z()));
  }
  /// Pixel of the captured picture -> undistorted normalized coordinates (x/z, y/z).
  Eigen::Vector2d unproject(const Eigen::Vector2d& px) const {
    return undistort({(px.x() - cx) / fx, (px.y() - cy) / fy});
  }
  /// Normalized coordinates -> pixel, no distortion applied.
  Eigen::Vector2d toPixel(const Eigen::Vector2d& n) const {
    return {fx * n.x() + cx, fy * n.y() + cy};
  }

 private:
  Eigen::Vector2d undistortFisheye(const Eigen::Vector2d& d) const {
    const double thd = d.norm();
    if (thd < 1e-9) return d;
    double th = std::min(thd, std::numbers::pi / 2 - 1e-3);
    for (int i = 0; i < 20; ++i) {
      const double t2 = th * th;
      const double f = th * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) - thd;
      const double df = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
      if (df < 1e-3) break;
      th = std::clamp(th - f / df, 0.0, std::numbers::pi / 2 - 1e-3);
      if (std::abs(f) < 1e-12) break;
    }
    return d * (std::tan(th) / thd);
  }
};

}  // namespace depthscope
