#include "recon/dense/plane_sweep.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "types/vector_clones.hpp"

namespace depthscope::recon {
namespace {

constexpr int kBits = 5;  // of a pixel's fraction
constexpr int kOne = 1 << kBits;
/// Added to the cost of a place that a single source sees: nothing confirms it.
constexpr int kLonelyCost = 20;
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

// By value: through the references of std::min and std::max the compiler finds no vectors.
[[gnu::always_inline]] inline float atLeast(float low, float v) {
  return v < low ? low : v;
}
[[gnu::always_inline]] inline float atMost(float high, float v) {
  return v > high ? high : v;
}

/// Packs each pixel with its right, lower and lower right neighbour, so that one access gets all.
/// What may not be used is 0 itself.
DEPTHSCOPE_CLONES
void packRow(int width, const std::uint8_t* __restrict upper, const std::uint8_t* __restrict lower,
             const std::uint8_t* __restrict usable, std::uint32_t* __restrict to) {
  for (int x = 0; x + 1 < width; ++x) {
    const std::uint8_t luma = upper[x] > 0 ? upper[x] : std::uint8_t{1};
    to[x] = static_cast<std::uint32_t>(usable[x] != 0 ? luma : std::uint8_t{0}) |
            static_cast<std::uint32_t>(upper[x + 1]) << 8 |
            static_cast<std::uint32_t>(lower[x]) << 16 |
            static_cast<std::uint32_t>(lower[x + 1]) << 24;
  }
}

void pack(const RectifiedLevel& picture, Grid<std::uint32_t>& out) {
  const Grid<std::uint8_t>& luma = picture.luma;
  out.resize(luma.width, luma.height);
  for (int y = 0; y + 1 < luma.height; ++y)
    packRow(luma.width, luma.row(y), luma.row(y + 1), picture.usable.row(y), out.row(y));
}

/// Where one row of the reference lies in a source, and whether that is inside. Windows at the
/// border of the source go on with its outermost pixels. Weights are of the fractions of a pixel:
/// that to the right in the lower half, that downwards in the upper.
struct RowWarp {
  Eigen::Vector3f start, step, per_depth;  // homogeneous source pixel: start + x step + q per_depth
  int width, height;
};
DEPTHSCOPE_CLONES
void placeRow(const RowWarp& w, const float* __restrict centre, float offset,
              std::int32_t* __restrict place, std::uint32_t* __restrict weights,
              std::uint8_t* __restrict usable) {
  const float right = static_cast<float>(w.width - 1) - 1.f / kOne;
  const float bottom = static_cast<float>(w.height - 1) - 1.f / kOne;
  const float u0 = w.start[0], v0 = w.start[1], z0 = w.start[2];
  const float du = w.step[0], dv = w.step[1], dz = w.step[2];
  const float eu = w.per_depth[0], ev = w.per_depth[1], ez = w.per_depth[2];
  const int width = w.width;
  for (int x = 0; x < width; ++x) {
    const float q = atLeast(0, centre[x] + offset), fx = static_cast<float>(x);
    const float per_z = 1 / atLeast(kMinDepthRatio, z0 + dz * fx + q * ez);
    const float u = (u0 + du * fx + q * eu) * per_z;
    const float v = (v0 + dv * fx + q * ev) * per_z;
    const float inside_u = atMost(right, atLeast(0, u));
    const float inside_v = atMost(bottom, atLeast(0, v));
    const int fixed_u = static_cast<int>(inside_u * kOne + 0.5f);
    const int fixed_v = static_cast<int>(inside_v * kOne + 0.5f);
    place[x] = (fixed_v >> kBits) * width + (fixed_u >> kBits);
    weights[x] = static_cast<std::uint32_t>((fixed_u & (kOne - 1)) | (fixed_v & (kOne - 1)) << 16);
    const float outside = std::abs(u - inside_u) + std::abs(v - inside_v) + (q > 0 ? 0.f : 1.f);
    usable[x] = static_cast<std::uint8_t>(outside > 0 ? 0 : 1);
  }
}

DEPTHSCOPE_CLONES
void keepTwoBest(std::size_t n, const std::uint8_t* __restrict cost, std::uint8_t* __restrict best,
                 std::uint8_t* __restrict second) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t worse = std::max(best[i], cost[i]);
    second[i] = std::min(second[i], worse);
    best[i] = std::min(best[i], cost[i]);
  }
}

/// The mean of the two best costs.
DEPTHSCOPE_CLONES
void meanOfTwo(std::size_t n, const std::uint8_t* __restrict best,
               const std::uint8_t* __restrict second, std::uint8_t* __restrict to) {
  for (std::size_t i = 0; i < n; ++i) {
    const int lonely = best[i] + kLonelyCost;
    const int next = second[i] < lonely ? second[i] : lonely;
    to[i] = static_cast<std::uint8_t>((best[i] + next + 1) / 2);
  }
}

/// Puts the costs of each pixel at four hypotheses side by side, pixels `stride` bytes apart.
DEPTHSCOPE_CLONES
void weaveFour(std::size_t n, const std::uint8_t* __restrict a, const std::uint8_t* __restrict b,
               const std::uint8_t* __restrict c, const std::uint8_t* __restrict d,
               std::size_t stride, std::uint8_t* __restrict to) {
  const auto weave = [&](std::size_t i, std::uint8_t* at) {
    const std::uint32_t four =
        static_cast<std::uint32_t>(a[i]) | static_cast<std::uint32_t>(b[i]) << 8 |
        static_cast<std::uint32_t>(c[i]) << 16 | static_cast<std::uint32_t>(d[i]) << 24;
    std::memcpy(at, &four, sizeof four);
  };
  if (stride == sizeof(std::uint32_t))  // for vectors
    for (std::size_t i = 0; i < n; ++i) weave(i, to + i * sizeof(std::uint32_t));
  else
    for (std::size_t i = 0; i < n; ++i) weave(i, to + i * stride);
}

/// The neighbours of the pixels that a row lies on.
DEPTHSCOPE_CLONES
void gatherRow(int width, const std::uint32_t* __restrict quads,
               const std::int32_t* __restrict place, std::uint32_t* __restrict to) {
  for (int x = 0; x < width; ++x) to[x] = quads[place[x]];
}

/// Bilinear interpolation; leaves usable what is there, too. In the windows of others what may not
/// be used is as its right neighbour.
DEPTHSCOPE_CLONES
void blendRow(int width, const std::uint32_t* __restrict quads,
              const std::uint32_t* __restrict weights, std::uint8_t* __restrict to,
              std::uint8_t* __restrict usable) {
  for (int x = 0; x < width; ++x) {
    const auto quad = static_cast<std::int32_t>(quads[x] & 0xffffff);
    const std::int32_t a = static_cast<std::int32_t>(weights[x] & 0xffff);
    const std::int32_t b = static_cast<std::int32_t>(weights[x] >> 16);
    const std::int32_t own = quad & 0xff, right = quad >> 8 & 0xff;
    const std::int32_t left = own > 0 ? own : right;
    const std::int32_t upper = (kOne - a) * left + a * right;
    const std::int32_t lower =
        (kOne - a) * (quad >> 16) + a * static_cast<std::int32_t>(quads[x] >> 24);
    to[x] = static_cast<std::uint8_t>(((kOne - b) * upper + b * lower + kOne * kOne / 2) >>
                                      (2 * kBits));
    usable[x] &= static_cast<std::uint8_t>(own > 0 ? 1 : 0);
  }
}

}  // namespace

void PlaneSweep::begin(const RectifiedLevel& reference, const std::vector<SweepSource>& sources,
                       int radius, float noise, CostVolume& volume) {
  const Grid<std::uint8_t>& luma = reference.luma;
  volume.width = luma.width;
  volume.height = luma.height;
  volume.cost.resize(luma.size() * static_cast<std::size_t>(volume.hypotheses));
  correlator_.setReference(luma, reference.usable, radius, noise);
  warped_.resize(luma.width, luma.height);
  usable_.resize(luma.width, luma.height);
  place_.resize(static_cast<std::size_t>(luma.width));
  weights_.resize(place_.size());
  row_quads_.resize(place_.size());
  packed_.resize(std::max(packed_.size(), sources.size()));
  for (std::size_t s = 0; s < sources.size(); ++s) pack(*sources[s].picture, packed_[s]);
}

void PlaneSweep::plane(const std::vector<SweepSource>& sources, const PinholeLevel& level, int k,
                       CostVolume& volume) {
  const float offset =
      (static_cast<float>(k) - static_cast<float>(volume.hypotheses - 1) / 2) * volume.step;
  best_.reset(volume.width, volume.height, 255);
  second_.reset(volume.width, volume.height, 255);
  const std::size_t n = best_.size();
  for (std::size_t s = 0; s < sources.size(); ++s) {
    warp(sources[s].T_source_reference, packed_[s], level, volume, offset);
    correlator_.cost(warped_, usable_, cost_);
    keepTwoBest(n, cost_.cells.data(), best_.cells.data(), second_.cells.data());
  }
  const int place = k % kWoven;
  std::vector<std::uint8_t>& costs = planes_[static_cast<std::size_t>(place)];
  costs.resize(n);
  meanOfTwo(n, best_.cells.data(), second_.cells.data(), costs.data());
  if (place == kWoven - 1)
    weaveFour(n, planes_[0].data(), planes_[1].data(), planes_[2].data(), planes_[3].data(),
              static_cast<std::size_t>(volume.hypotheses), volume.cost.data() + k - place);
}

void PlaneSweep::warp(const Pose& T_source_reference, const Grid<std::uint32_t>& quads,
                      const PinholeLevel& level, const CostVolume& volume, float offset) {
  const Warp w = warpOf(T_source_reference, level);
  for (int y = 0; y < volume.height; ++y) {
    const RowWarp row{w.H.col(1) * static_cast<float>(y) + w.H.col(2), w.H.col(0), w.e,
                      volume.width, volume.height};
    std::uint8_t* usable = usable_.row(y);
    placeRow(row, volume.centre.row(y), offset, place_.data(), weights_.data(), usable);
    gatherRow(volume.width, quads.cells.data(), place_.data(), row_quads_.data());
    blendRow(volume.width, row_quads_.data(), weights_.data(), warped_.row(y), usable);
  }
}

}  // namespace depthscope::recon
