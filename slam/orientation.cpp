#include "slam/orientation.hpp"

#include <array>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr int kSide = 2 * kPatchRadius + 1;
constexpr int kLanes = 32;  // a row of the patch and one pixel more

/// 255 within the disc, 0 outside.
constexpr auto kDisc = [] {
  std::array<std::array<std::uint8_t, kLanes>, kSide> disc{};
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v)
    for (int u = -kPatchRadius; u <= kPatchRadius; ++u)
      disc[v + kPatchRadius][u + kPatchRadius] =
          u * u + v * v <= kPatchRadius * kPatchRadius ? 255 : 0;
  return disc;
}();

}  // namespace

float intensityCentroidAngle(const std::uint8_t* centre, std::ptrdiff_t stride) {
  // Column sums of I and of v * I. 16 bits suffice: 255 * (1 + ... + 15) = 30600.
  std::array<std::int16_t, kLanes> sum{}, moment{};
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    const std::uint8_t* row = centre + v * stride - kPatchRadius;
    const auto& disc = kDisc[v + kPatchRadius];
    for (int i = 0; i < kLanes; ++i) {
      const auto value = static_cast<std::int16_t>(row[i] & disc[i]);
      sum[i] = static_cast<std::int16_t>(sum[i] + value);
      moment[i] = static_cast<std::int16_t>(moment[i] + value * static_cast<std::int16_t>(v));
    }
  }
  int m10 = 0, m01 = 0;
  for (int i = 0; i < kSide; ++i) {
    m10 += (i - kPatchRadius) * sum[i];
    m01 += moment[i];
  }
  return std::atan2(static_cast<float>(m01), static_cast<float>(m10));
}

}  // namespace depthscope::slam
