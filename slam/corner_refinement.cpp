#include "slam/corner_refinement.hpp"

#include <algorithm>

#include "slam/fast_score.hpp"

namespace depthscope::slam {
namespace {

constexpr double kReach = 0.7;  // [px] the maximum is nearest to this pixel, noise aside

}  // namespace

Eigen::Vector2d refineCorner(const std::uint8_t* centre, std::ptrdiff_t stride) {
  fast::Bytes16 rows[3];  // the first three of each are the scores of the neighbourhood
  const auto offsets = fast::circleOffsets(stride);
  for (int v = 0; v < 3; ++v) fast::scoreAt(centre + (v - 1) * stride - 1, offsets, rows[v]);

  // Least squares with weights (1 2 1) x (1 2 1), times 8.
  double gx = 0, gy = 0, xx = 0, yy = 0;
  for (int i = 0; i < 3; ++i) {
    const int weight = i == 1 ? 2 : 1;
    gx += weight * (rows[i][2] - rows[i][0]);
    gy += weight * (rows[2][i] - rows[0][i]);
    xx += 2 * weight * (rows[i][0] - 2 * rows[i][1] + rows[i][2]);
    yy += 2 * weight * (rows[0][i] - 2 * rows[1][i] + rows[2][i]);
  }
  const double xy = 2 * (rows[2][2] - rows[2][0] - rows[0][2] + rows[0][0]);
  if (xx >= 0 || yy >= 0) return Eigen::Vector2d::Zero();
  // A ridge has no maximum along itself: there the two directions are taken for themselves.
  const double det = xx * yy - xy * xy;
  const Eigen::Vector2d offset =
      det < 0.2 * xx * yy ? Eigen::Vector2d(-gx / xx, -gy / yy)
                          : Eigen::Vector2d((xy * gy - yy * gx) / det, (xy * gx - xx * gy) / det);
  return offset.cwiseMax(-kReach).cwiseMin(kReach);
}

}  // namespace depthscope::slam
