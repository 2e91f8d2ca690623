#include "recon/dense/depth_consistency.hpp"

#include <cmath>

namespace depthscope::recon {
namespace {

/// Adds to `votes` 1 where `other` agrees with `view` and -1 where it sees past.
void vote(const FusedView& view, const FusedView& other, const PinholeLevel& level,
          const DenseSettings& settings, Grid<std::int8_t>& votes) {
  const Pose T = other.T_camera_world * view.T_camera_world.inverse();
  const Eigen::Matrix3f R = T.R.cast<float>();
  const Eigen::Vector3f t = T.t.cast<float>();
  const auto tolerance_px = static_cast<float>(settings.agreement_px);
  const float tolerance = tolerance_px * std::max(view.map->precision * view.inverse_scale,
                                                  other.map->precision * other.inverse_scale);
  for (int y = 0; y < level.height; ++y) {
    const Eigen::Vector3f column = R.col(1) * ((y - level.cy) / level.f) + R.col(2);
    for (int x = 0; x < level.width; ++x) {
      const float q = view.map->inverse_depth.at(x, y) * view.inverse_scale;
      if (!(q > 0)) continue;
      // The point in the other's camera, times q.
      const Eigen::Vector3f p = column + R.col(0) * ((x - level.cx) / level.f) + q * t;
      if (!(p.z() > 0)) continue;
      const float u = level.f * p.x() / p.z() + level.cx + 0.5f;
      const float v = level.f * p.y() / p.z() + level.cy + 0.5f;
      if (!(u >= 0 && v >= 0 && u < level.width && v < level.height)) continue;
      const float seen = other.map->inverse_depth.at(static_cast<int>(u), static_cast<int>(v)) *
                         other.inverse_scale;
      if (!(seen > 0)) continue;
      const float expected = q / p.z();
      if (std::abs(seen - expected) < tolerance)
        ++votes.at(x, y);
      else if (seen < expected)
        --votes.at(x, y);
    }
  }
}

}  // namespace

void countAgreement(std::vector<FusedView>& views, std::size_t i, const PinholeLevel& level,
                    const DenseSettings& settings) {
  Grid<std::int8_t> votes(level.width, level.height, 0);
  for (std::size_t n : views[i].neighbours) vote(views[i], views[n], level, settings, votes);
  views[i].agreeing.reset(level.width, level.height);
  for (std::size_t c = 0; c < votes.size(); ++c)
    views[i].agreeing.cells[c] = static_cast<std::uint8_t>(std::max<int>(votes.cells[c], 0));
}

}  // namespace depthscope::recon
