#include "recon/dense/plane_sweep.hpp"

#include <Eigen/LU>
#include <cmath>

namespace depthscope::recon {
namespace {

constexpr int kBits = 5;  // of a pixel's fraction
constexpr int kOne = 1 << kBits;
/// Added to the cost of a place that a single source sees: nothing confirms it.
constexpr int kLonelyCost = 40;
/// A place this near to the plane of the source's camera, as a share of its depth, is not seen.
constexpr float kMinDepthRatio = 1e-3f;

/// Source pixel of reference pixel (x, y) at inverse depth q: dehomogenized H (x, y, 1) + q e.
struct Warp {
  Eigen::Matrix3f H;
  Eigen::Vector3f e;
};

Warp warpOf(const Pose& T_source_reference, const PinholeLevel& level) {
  Eigen::Matrix3d K;
  K << level.f, 0, level.cx, 0, level.f, level.cy, 0, 0, 1;
  return {(K * T_source_reference.R * K.inverse()).cast<float>(),
          (K * T_source_reference.t).cast<float>()};
}

}  // namespace

void PlaneSweep::begin(const RectifiedLevel& reference, int radius, float noise,
                       CostVolume& volume) {
  const Grid<std::uint8_t>& luma = reference.luma;
  volume.width = luma.width;
  volume.height = luma.height;
  volume.cost.resize(luma.size() * static_cast<std::size_t>(volume.hypotheses));
  correlator_.setReference(luma, reference.usable, radius, noise);
  warped_.reset(luma.width, luma.height);
  usable_.reset(luma.width, luma.height);
  u_.resize(static_cast<std::size_t>(luma.width));
  v_.resize(u_.size());
}

void PlaneSweep::plane(const std::vector<SweepSource>& sources, const PinholeLevel& level, int k,
                       CostVolume& volume) {
  const float offset =
      (static_cast<float>(k) - static_cast<float>(volume.hypotheses - 1) / 2) * volume.step;
  best_.reset(volume.width, volume.height, 255);
  second_.reset(volume.width, volume.height, 255);
  const std::size_t n = best_.size();
  for (const SweepSource& source : sources) {
    warp(source, level, volume, offset);
    correlator_.cost(warped_, usable_, cost_);
    std::uint8_t* best = best_.cells.data();
    std::uint8_t* second = second_.cells.data();
    const std::uint8_t* cost = cost_.cells.data();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint8_t worse = std::max(best[i], cost[i]);
      second[i] = std::min(second[i], worse);
      best[i] = std::min(best[i], cost[i]);
    }
  }
  std::uint8_t* to = volume.cost.data() + k;
  for (std::size_t i = 0; i < n; ++i) {
    const int lonely = std::min(best_.cells[i] + kLonelyCost, 255);
    const int second = std::min<int>(second_.cells[i], lonely);
    to[i * static_cast<std::size_t>(volume.hypotheses)] =
        static_cast<std::uint8_t>((best_.cells[i] + second + 1) / 2);
  }
}

void PlaneSweep::warp(const SweepSource& source, const PinholeLevel& level,
                      const CostVolume& volume, float offset) {
  const Warp w = warpOf(source.T_source_reference, level);
  const Grid<std::uint8_t>& luma = source.picture->luma;
  const float right = static_cast<float>(luma.width - 1) - 1.f / kOne;
  const float bottom = static_cast<float>(luma.height - 1) - 1.f / kOne;
  for (int y = 0; y < volume.height; ++y) {
    const Eigen::Vector3f start = w.H.col(1) * static_cast<float>(y) + w.H.col(2);
    const float* centre = volume.centre.row(y);
    std::uint8_t* usable = usable_.row(y);
    for (int x = 0; x < volume.width; ++x) {
      const float q = std::max(centre[x] + offset, 0.f), fx = static_cast<float>(x);
      const float z = std::max(start.z() + w.H(2, 0) * fx + q * w.e.z(), kMinDepthRatio);
      const float u = (start.x() + w.H(0, 0) * fx + q * w.e.x()) / z;
      const float v = (start.y() + w.H(1, 0) * fx + q * w.e.y()) / z;
      const float inside_u = std::min(std::max(u, 0.f), right);
      const float inside_v = std::min(std::max(v, 0.f), bottom);
      // Windows at the border of the source go on with its outermost pixels.
      u_[static_cast<std::size_t>(x)] = static_cast<int>(inside_u * kOne + 0.5f);
      v_[static_cast<std::size_t>(x)] = static_cast<int>(inside_v * kOne + 0.5f);
      usable[x] = (u == inside_u) & (v == inside_v) & (q > 0);
    }
    sample(*source.picture, y);
  }
}

/// Bilinear interpolation of one row at u_, v_.
void PlaneSweep::sample(const RectifiedLevel& source, int y) {
  const Grid<std::uint8_t>& luma = source.luma;
  const std::uint8_t* pixels = luma.cells.data();
  const std::uint8_t* usable_there = source.usable.cells.data();
  std::uint8_t* to = warped_.row(y);
  std::uint8_t* usable = usable_.row(y);
  for (int x = 0; x < luma.width; ++x) {
    const std::int32_t u = u_[static_cast<std::size_t>(x)], v = v_[static_cast<std::size_t>(x)];
    const std::ptrdiff_t place = (v >> kBits) * luma.width + (u >> kBits);
    const std::uint8_t* upper = pixels + place;
    const std::uint8_t* lower = upper + luma.width;
    const int a = u & (kOne - 1), b = v & (kOne - 1);
    const int value = (kOne - b) * ((kOne - a) * upper[0] + a * upper[1]) +
                      b * ((kOne - a) * lower[0] + a * lower[1]);
    to[x] = static_cast<std::uint8_t>((value + kOne * kOne / 2) >> (2 * kBits));
    usable[x] &= usable_there[place];
  }
}

}  // namespace depthscope::recon
