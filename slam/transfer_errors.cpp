#include "slam/transfer_errors.hpp"

#include <Eigen/LU>
#include <limits>

#include "types/vector_clones.hpp"

namespace depthscope::slam {
namespace {

constexpr int kLanes = 8;  // sums that run side by side
static_assert(TransferErrors::block % kLanes == 0);

Eigen::Matrix3d cameraMatrix(const Intrinsics& c) {
  Eigen::Matrix3d K;
  K << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  return K;
}

/// Squared distances between what the homography makes of places and where they are.
DEPTHSCOPE_CLONES
void transferDistances(const float* __restrict H, const float* __restrict from_x,
                       const float* __restrict from_y, const float* __restrict to_x,
                       const float* __restrict to_y, int count, float* __restrict distances) {
  for (int i = 0; i < count; ++i) {
    const float w = H[6] * from_x[i] + H[7] * from_y[i] + H[8];
    const float dx = (H[0] * from_x[i] + H[1] * from_y[i] + H[2]) / w - to_x[i];
    const float dy = (H[3] * from_x[i] + H[4] * from_y[i] + H[5]) / w - to_y[i];
    distances[i] = dx * dx + dy * dy;
  }
}

/// Squared distances to the epipolar lines in both views.
DEPTHSCOPE_CLONES
void epipolarDistances(const float* __restrict F, const MatchBlock& m, float* __restrict in_second,
                       float* __restrict in_first) {
  for (int i = 0; i < m.count; ++i) {
    const float x1 = m.first_x[i], y1 = m.first_y[i], x2 = m.second_x[i], y2 = m.second_y[i];
    const float a = F[0] * x1 + F[1] * y1 + F[2];
    const float b = F[3] * x1 + F[4] * y1 + F[5];
    const float c = F[6] * x1 + F[7] * y1 + F[8];
    const float a2 = F[0] * x2 + F[3] * y2 + F[6];
    const float b2 = F[1] * x2 + F[4] * y2 + F[7];
    const float e = a * x2 + b * y2 + c;
    in_second[i] = e * e / (a * a + b * b);
    in_first[i] = e * e / (a2 * a2 + b2 * b2);
  }
}

void endAfter(const MatchBlock& m, TransferErrors& e) {
  for (auto* errors : {&e.in_second, &e.in_first})
    std::fill(errors->begin() + m.count, errors->end(), std::numeric_limits<float>::infinity());
}

}  // namespace

MatchBlock matchBlock(const TwoViewMatches& m, int begin) {
  return {m.first_x.data() + begin, m.first_y.data() + begin, m.second_x.data() + begin,
          m.second_y.data() + begin, std::min(TransferErrors::block, m.size() - begin)};
}

HomographyErrors::HomographyErrors(const Intrinsics& camera, const Eigen::Matrix3d& H) {
  const Eigen::Matrix3d K = cameraMatrix(camera);
  const Eigen::Matrix3d on_pixels = K * H * K.inverse();
  H_second_first_ = on_pixels.cast<float>();
  H_first_second_ = on_pixels.inverse().cast<float>();
}

void HomographyErrors::operator()(const MatchBlock& m, TransferErrors& e) const {
  transferDistances(H_second_first_.data(), m.first_x, m.first_y, m.second_x, m.second_y, m.count,
                    e.in_second.data());
  transferDistances(H_first_second_.data(), m.second_x, m.second_y, m.first_x, m.first_y, m.count,
                    e.in_first.data());
  endAfter(m, e);
}

EpipolarErrors::EpipolarErrors(const Intrinsics& camera, const Eigen::Matrix3d& E) {
  const Eigen::Matrix3d K_inv = cameraMatrix(camera).inverse();
  F_ = (K_inv.transpose() * E * K_inv).normalized().cast<float>();
}

void EpipolarErrors::operator()(const MatchBlock& m, TransferErrors& e) const {
  epipolarDistances(F_.data(), m, e.in_second.data(), e.in_first.data());
  endAfter(m, e);
}

DEPTHSCOPE_CLONES
Left whatIsLeft(const TransferErrors& e, float threshold, float whole) {
  std::array<float, kLanes> sum{};
  std::array<int, kLanes> inliers{};
  for (int i = 0; i < TransferErrors::block; i += kLanes)
    for (int lane = 0; lane < kLanes; ++lane) {
      const float e1 = e.in_second[i + lane], e2 = e.in_first[i + lane];
      sum[lane] += (e1 < threshold ? whole - e1 : 0) + (e2 < threshold ? whole - e2 : 0);
      inliers[lane] += (e1 < threshold) & (e2 < threshold);
    }
  Left left;
  for (int lane = 0; lane < kLanes; ++lane) {
    left.sum += sum[lane];
    left.inliers += inliers[lane];
  }
  return left;
}

}  // namespace depthscope::slam
