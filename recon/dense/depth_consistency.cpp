#include "recon/dense/depth_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "types/vector_clones.hpp"

namespace depthscope::recon {
namespace {

/// One row of a depth map on its way into another picture: the row's points there, times their
/// inverse depth q, are start + x step + q shift.
struct RowInOther {
  Eigen::Vector3f start, step, shift;
  float f, cx, cy;  // of the other picture
  int width, height;
};

/// Where in the other picture the row's points lie, and the inverse depths they would have there,
/// which are NaN where that is outside or unknown.
DEPTHSCOPE_CLONES
void placeRow(const RowInOther& row, float scale, const float* __restrict inverse_depth,
              std::int32_t* __restrict place, float* __restrict expected) {
  const float x0 = row.start[0], y0 = row.start[1], z0 = row.start[2];
  const float dx = row.step[0], dy = row.step[1], dz = row.step[2];
  const float ex = row.shift[0], ey = row.shift[1], ez = row.shift[2];
  const float cx = row.cx + 0.5f, cy = row.cy + 0.5f, f = row.f;
  const int width = row.width, height = row.height;
  for (int x = 0; x < width; ++x) {
    const float q = inverse_depth[x] * scale, fx = static_cast<float>(x);
    const float px = x0 + fx * dx + q * ex, py = y0 + fx * dy + q * ey, pz = z0 + fx * dz + q * ez;
    const float u = f * px / pz + cx, v = f * py / pz + cy;
    // Far outside is cut to just outside, for it may be no integer. By value: through references
    // the compiler finds no vectors.
    const float low_u = u > -1 ? u : -1, low_v = v > -1 ? v : -1;
    const int column = static_cast<int>(low_u < 32767 ? low_u : 32767);
    const int line = static_cast<int>(low_v < 32767 ? low_v : 32767);
    const bool inside = static_cast<int>(q > 0) & static_cast<int>(pz > 0) &
                        static_cast<int>(u >= 0) & static_cast<int>(v >= 0) &
                        static_cast<int>(column < width) & static_cast<int>(line < height);
    place[x] = inside ? line * width + column : 0;
    expected[x] = inside ? q / pz : std::numeric_limits<float>::quiet_NaN();
  }
}

/// Adds to each vote 1 where the other depth map agrees with what is expected there and -1 where it
/// sees past. Inverse depths of 0, unknown, and of NaN do neither.
DEPTHSCOPE_CLONES
void voteRow(int width, const float* __restrict other, float scale, float tolerance,
             const std::int32_t* __restrict place, const float* __restrict expected,
             float* __restrict seen, std::int8_t* __restrict votes) {
  for (int x = 0; x < width; ++x) seen[x] = other[place[x]] * scale;
  for (int x = 0; x < width; ++x) {
    const float difference = seen[x] - expected[x];
    const int known = seen[x] > 0 ? 1 : 0;
    const int agrees = std::abs(difference) < tolerance ? 1 : 0;
    const int past = difference <= -tolerance ? 1 : 0;
    votes[x] = static_cast<std::int8_t>(votes[x] + known * (agrees - past));
  }
}

/// Adds to `votes` 1 where `other` agrees with `view` and -1 where it sees past.
void vote(const FusedView& view, const FusedView& other, const PinholeLevel& level,
          const DenseSettings& settings, Grid<std::int8_t>& votes) {
  const Pose T = other.T_camera_world * view.T_camera_world.inverse();
  const Eigen::Matrix3f R = T.R.cast<float>();
  const auto tolerance_px = static_cast<float>(settings.agreement_px);
  const float tolerance = tolerance_px * std::max(view.map->precision * view.inverse_scale,
                                                  other.map->precision * other.inverse_scale);
  const Eigen::Vector3f step = R.col(0) / level.f;
  std::vector<std::int32_t> place(static_cast<std::size_t>(level.width));
  std::vector<float> expected(place.size()), seen(place.size());
  for (int y = 0; y < level.height; ++y) {
    const float fy = (static_cast<float>(y) - level.cy) / level.f;
    const RowInOther row{R.col(1) * fy + R.col(2) - level.cx * step,
                         step,
                         T.t.cast<float>(),
                         level.f,
                         level.cx,
                         level.cy,
                         level.width,
                         level.height};
    placeRow(row, view.inverse_scale, view.map->inverse_depth.row(y), place.data(),
             expected.data());
    voteRow(level.width, other.map->inverse_depth.cells.data(), other.inverse_scale, tolerance,
            place.data(), expected.data(), seen.data(), votes.row(y));
  }
}

}  // namespace

void countAgreement(std::vector<FusedView>& views, std::size_t i, const PinholeLevel& level,
                    const DenseSettings& settings) {
  Grid<std::int8_t> votes(level.width, level.height, 0);
  for (std::size_t n : views[i].neighbours) vote(views[i], views[n], level, settings, votes);
  views[i].agreeing.reset(level.width, level.height);
  for (std::size_t c = 0; c < votes.size(); ++c)
    views[i].agreeing.cells[c] = static_cast<std::uint8_t>(
        views[i].map->inverse_depth.cells[c] > 0 ? std::max(votes.cells[c] + 1, 0) : 0);
}

}  // namespace depthscope::recon
