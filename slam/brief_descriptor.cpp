#include "slam/brief_descriptor.hpp"

#include <cmath>
#include <numbers>

#include "slam/brief_pattern.hpp"
#include "slam/orientation.hpp"

namespace depthscope::slam {
namespace {

constexpr int kPatchStride = 32;
constexpr int kPatchRows = 2 * kPatchRadius + 1;

using Patch = std::array<std::uint8_t, static_cast<std::size_t>(kPatchStride) * kPatchRows>;

std::uint8_t average(std::uint8_t a, std::uint8_t b) {
  return static_cast<std::uint8_t>((a + b + 1) >> 1);
}

/// The patch around `centre`, as BinomialSmoothing would smooth it. A compact copy: the places of
/// tests do not depend on the picture's stride, and all of it stays in the cache.
void smoothPatch(const std::uint8_t* centre, std::ptrdiff_t stride, Patch& patch) {
  constexpr int kWide = kPatchStride + 16;
  std::array<std::uint8_t, static_cast<std::size_t>(kWide) * kPatchRows> columns;
  for (int v = 0; v < kPatchRows; ++v) {
    const std::uint8_t* here = centre + (v - kPatchRadius) * stride - kPatchRadius - 1;
    const std::uint8_t *above = here - stride, *below = here + stride;
    std::uint8_t* out = columns.data() + v * kWide;
    for (int i = 0; i < kWide; ++i) out[i] = average(average(above[i], below[i]), here[i]);
  }
  for (int v = 0; v < kPatchRows; ++v) {
    const std::uint8_t* row = columns.data() + v * kWide;
    std::uint8_t* out = patch.data() + v * kPatchStride;
    for (int i = 0; i < kPatchStride; ++i)
      out[i] = average(average(row[i], row[i + 2]), row[i + 1]);
  }
}

std::uint16_t turnedPlace(int x, int y, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto u = static_cast<int>(std::lround(c * x - s * y));
  const auto v = static_cast<int>(std::lround(s * x + c * y));
  return static_cast<std::uint16_t>((v + kPatchRadius) * kPatchStride + u + kPatchRadius);
}

}  // namespace

BriefDescriptor::BriefDescriptor() : turned_(kAngleSteps) {
  for (int a = 0; a < kAngleSteps; ++a) {
    const double angle = 2 * std::numbers::pi * a / kAngleSteps;
    for (std::size_t i = 0; i < kTests; ++i) {
      const BriefTest& test = kBriefPattern[i];
      turned_[a][2 * i] = turnedPlace(test.x0, test.y0, angle);
      turned_[a][2 * i + 1] = turnedPlace(test.x1, test.y1, angle);
    }
  }
}

Descriptor BriefDescriptor::operator()(const std::uint8_t* centre, std::ptrdiff_t stride,
                                       float angle) const {
  Patch patch;
  smoothPatch(centre, stride, patch);
  const float steps = angle * (kAngleSteps / (2 * std::numbers::pi_v<float>));
  const auto step = static_cast<unsigned>(static_cast<int>(std::lround(steps)) + kAngleSteps);
  const std::uint16_t* place = turned_[step % kAngleSteps].data();
  Descriptor descriptor;
  for (std::uint64_t& word : descriptor.bits) {
    std::uint64_t bits = 0;
    for (int i = 0; i < 64; ++i, place += 2)
      bits |= static_cast<std::uint64_t>(patch[place[0]] < patch[place[1]]) << i;
    word = bits;
  }
  return descriptor;
}

}  // namespace depthscope::slam
