#include "slam/gaussian_blur.hpp"

#include <algorithm>

namespace depthscope::slam {
namespace {

constexpr int kRadius = 3;

/// Weighs seven taps placed symmetrically: exp(-k^2 / (2 * 2^2)) in 1/256, which keeps the sum
/// within 16 bits.
DEPTHSCOPE_KERNEL std::uint8_t weigh(std::uint16_t centre, std::uint16_t pair1, std::uint16_t pair2,
                                     std::uint16_t pair3) {
  const auto a = static_cast<std::uint16_t>(centre * 56),
             b = static_cast<std::uint16_t>(pair1 * 49);
  const auto c = static_cast<std::uint16_t>(pair2 * 33), d = static_cast<std::uint16_t>(pair3 * 18);
  // The largest sum is 255 * 256 + 128 < 2^16.
  const auto ab = static_cast<std::uint16_t>(a + b), cd = static_cast<std::uint16_t>(c + d);
  return static_cast<std::uint8_t>(static_cast<std::uint16_t>(ab + cd + 128) >> 8);
}

DEPTHSCOPE_KERNEL std::uint16_t pair(const std::uint8_t* a, const std::uint8_t* b, int x) {
  return static_cast<std::uint16_t>(a[x] + b[x]);
}

/// taps[k]: the row k - 3 below the one asked for.
DEPTHSCOPE_KERNEL void vertical(const std::uint8_t* const* taps, int width, std::uint8_t* out) {
  const std::uint8_t *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3];
  const std::uint8_t *e = taps[4], *f = taps[5], *g = taps[6];
  for (int x = 0; x < width; ++x) out[x] = weigh(d[x], pair(c, e, x), pair(b, f, x), pair(a, g, x));
}

DEPTHSCOPE_KERNEL void horizontal(const std::uint8_t* row, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x)
    out[x] = weigh(row[x], pair(row - 1, row + 1, x), pair(row - 2, row + 2, x),
                   pair(row - 3, row + 3, x));
}

/// `row` has kRadius pixels before its first and behind its last.
DEPTHSCOPE_KERNEL void blurRow(const std::uint8_t* const* taps, int width,
                               std::uint8_t* __restrict row, std::uint8_t* __restrict out) {
  vertical(taps, width, row);
  std::fill_n(row - kRadius, kRadius, row[0]);
  std::fill_n(row + width, kRadius, row[width - 1]);
  horizontal(row, width, out);
}

void blurRowPortable(const std::uint8_t* const* taps, int width, std::uint8_t* row,
                     std::uint8_t* out) {
  blurRow(taps, width, row, out);
}

#if DEPTHSCOPE_HAS_AVX2
DEPTHSCOPE_AVX2 void blurRowAvx2(const std::uint8_t* const* taps, int width, std::uint8_t* row,
                                 std::uint8_t* out) {
  blurRow(taps, width, row, out);
}
#else
constexpr auto blurRowAvx2 = blurRowPortable;
#endif

}  // namespace

GaussianBlur::GaussianBlur(int width) : row_(width + 2 * 64) {}

void GaussianBlur::operator()(const ImageBuffer& source, ImageBuffer& out, SimdPath path) {
  const auto blur = path == SimdPath::Avx2 ? blurRowAvx2 : blurRowPortable;
  for (int y = 0; y < source.height(); ++y) {
    const std::uint8_t* taps[2 * kRadius + 1];
    for (int k = -kRadius; k <= kRadius; ++k)
      taps[k + kRadius] = source.row(std::clamp(y + k, 0, source.height() - 1));
    blur(taps, source.width(), row_.data() + 64, out.row(y));
  }
}

}  // namespace depthscope::slam
