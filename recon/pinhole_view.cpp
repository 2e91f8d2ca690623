#include "recon/pinhole_view.hpp"

#include <cmath>

namespace depthscope::recon {
namespace {

constexpr float kMaxTangent = 1.5f;            // 56 degrees: beyond, a pinhole wastes its pixels
constexpr int kMultiple = 1 << (kLevels - 1);  // so that every level halves evenly

struct Extent {
  float left = 0, right = 0, top = 0, bottom = 0;  // normalized coordinates
};

/// What the picture's border spans after undistortion.
Extent visibleExtent(const CameraModel& camera, float limit) {
  Extent e;
  const auto take = [&](double x, double y) {
    const Eigen::Vector2d n = camera.unproject({x, y});
    e.left = std::min(e.left, static_cast<float>(n.x()));
    e.right = std::max(e.right, static_cast<float>(n.x()));
    e.top = std::min(e.top, static_cast<float>(n.y()));
    e.bottom = std::max(e.bottom, static_cast<float>(n.y()));
  };
  constexpr int kSteps = 32;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = (camera.width - 1.0) * i / kSteps, y = (camera.height - 1.0) * i / kSteps;
    take(x, 0);
    take(x, camera.height - 1.0);
    take(0, y);
    take(camera.width - 1.0, y);
  }
  return {std::max(e.left, -limit), std::min(e.right, limit), std::max(e.top, -limit),
          std::min(e.bottom, limit)};
}

int roundUp(float size) {
  return (static_cast<int>(std::ceil(size)) + kMultiple - 1) / kMultiple * kMultiple;
}

}  // namespace

PinholeLevel finestLevel(const CameraModel& camera, int factor, int max_width) {
  const Extent e = visibleExtent(camera, kMaxTangent);
  const auto wanted =
      static_cast<float>(std::sqrt(camera.fx * camera.fy)) / static_cast<float>(factor);
  const float f = std::min(wanted, static_cast<float>(max_width) / (e.right - e.left));
  return {roundUp(f * (e.right - e.left)), roundUp(f * (e.bottom - e.top)), f, -f * e.left,
          -f * e.top};
}

PinholeView::PinholeView(const CameraModel& camera, int factor, int max_width) {
  const PinholeLevel finest = levels_[0] = finestLevel(camera, factor, max_width);
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    const PinholeLevel& fine = levels_[l - 1];
    levels_[l] = {fine.width / 2, fine.height / 2, fine.f / 2, (fine.cx - 0.5f) / 2,
                  (fine.cy - 0.5f) / 2};
  }
  source_.reset(finest.width, finest.height, Eigen::Vector2f(-1, -1));
  const int reduced_width = camera.width / factor, reduced_height = camera.height / factor;
  for (int y = 0; y < finest.height; ++y)
    for (int x = 0; x < finest.width; ++x) {
      const Eigen::Vector3d ray((x - finest.cx) / finest.f, (y - finest.cy) / finest.f, 1);
      const Eigen::Vector2d captured = camera.project(ray);
      // Beyond its edge the lens model may fold back into the picture.
      const bool one_to_one = (camera.unproject(captured) - ray.head<2>()).norm() < 1e-3;
      // The centre of a reduced pixel is that of its factor x factor pixels.
      const Eigen::Vector2d p = (captured.array() + 0.5) / factor - 0.5;
      const bool inside =
          p.x() >= 0 && p.y() >= 0 && p.x() <= reduced_width - 1 && p.y() <= reduced_height - 1;
      source_.at(x, y) =
          one_to_one && inside ? Eigen::Vector2f(p.cast<float>()) : Eigen::Vector2f(-1, -1);
    }
}

void PinholeView::rectify(const Grid<std::uint8_t>& reduced, Grid<std::uint8_t>& out) const {
  out.reset(source_.width, source_.height);
  for (std::size_t i = 0; i < source_.size(); ++i) {
    const Eigen::Vector2f& p = source_.cells[i];
    if (p.x() < 0) continue;
    const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
    const float a = p.x() - static_cast<float>(x), b = p.y() - static_cast<float>(y);
    const std::uint8_t* upper = reduced.row(y);
    const std::uint8_t* lower = reduced.row(std::min(y + 1, reduced.height - 1));
    const int right = std::min(x + 1, reduced.width - 1);
    const float value = (1 - b) * ((1 - a) * upper[x] + a * upper[right]) +
                        b * ((1 - a) * lower[x] + a * lower[right]);
    out.cells[i] = static_cast<std::uint8_t>(value + 0.5f);
  }
}

}  // namespace depthscope::recon
