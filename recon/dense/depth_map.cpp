#include "recon/dense/depth_map.hpp"

#include <cmath>
#include <numbers>

namespace depthscope::recon {

void measureSlant(DepthMap& map, const PinholeLevel& level, double max_tilt_deg) {
  constexpr int kStep = 2;  // [px] over which the gradient is taken
  const auto least = static_cast<float>(std::cos(max_tilt_deg * std::numbers::pi / 180));
  const Grid<float>& depth = map.inverse_depth;
  map.slant.reset(depth.width, depth.height);
  const auto slope = [&](int x, int y, int dx, int dy) {
    const float here = depth.at(x, y);
    const float before = depth.clamped(x - kStep * dx, y - kStep * dy);
    const float after = depth.clamped(x + kStep * dx, y + kStep * dy);
    if (before > 0 && after > 0) return (after - before) / (2 * kStep);
    if (after > 0) return (after - here) / kStep;
    return before > 0 ? (here - before) / kStep : 0.f;
  };
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float q = depth.at(x, y);
      if (!(q > 0)) continue;
      // The plane n p = d has inverse depth q = n ray / d: linear in the pixel.
      const float du = slope(x, y, 1, 0), dv = slope(x, y, 0, 1);
      const Eigen::Vector2f offset(static_cast<float>(x) - level.cx,
                                   static_cast<float>(y) - level.cy);
      const Eigen::Vector3f n_over_d(level.f * du, level.f * dv,
                                     q - du * offset.x() - dv * offset.y());
      const float slant = q / n_over_d.norm();
      const float ray = std::sqrt(1 + offset.squaredNorm() / (level.f * level.f));
      map.slant.at(x, y) = slant >= least * ray ? slant : 0;
    }
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (map.slant.cells[i] == 0) map.inverse_depth.cells[i] = 0, map.confidence.cells[i] = 0;
}

}  // namespace depthscope::recon
