#include "slam/binomial_smoothing.hpp"

#include <algorithm>

namespace depthscope::slam {
namespace {

constexpr int kAlign = 64;  // [bytes] before the first pixel of row_, so that loads are aligned

DEPTHSCOPE_KERNEL std::uint8_t average(std::uint8_t a, std::uint8_t b) {
  return static_cast<std::uint8_t>((a + b + 1) >> 1);
}

/// `row` has a pixel to spare before its first and behind its last.
DEPTHSCOPE_KERNEL void smoothRow(const std::uint8_t* above, const std::uint8_t* here,
                                 const std::uint8_t* below, int width, std::uint8_t* __restrict row,
                                 std::uint8_t* __restrict out) {
  for (int x = 0; x < width; ++x) row[x] = average(average(above[x], below[x]), here[x]);
  row[-1] = row[0];
  row[width] = row[width - 1];
  for (int x = 0; x < width; ++x) out[x] = average(average(row[x - 1], row[x + 1]), row[x]);
}

void smoothRowPortable(const std::uint8_t* above, const std::uint8_t* here,
                       const std::uint8_t* below, int width, std::uint8_t* row, std::uint8_t* out) {
  smoothRow(above, here, below, width, row, out);
}

#if DEPTHSCOPE_HAS_AVX2
DEPTHSCOPE_AVX2 void smoothRowAvx2(const std::uint8_t* above, const std::uint8_t* here,
                                   const std::uint8_t* below, int width, std::uint8_t* row,
                                   std::uint8_t* out) {
  smoothRow(above, here, below, width, row, out);
}
#else
constexpr auto smoothRowAvx2 = smoothRowPortable;
#endif

}  // namespace

BinomialSmoothing::BinomialSmoothing(int width) : row_(width + 2 * kAlign) {}

void BinomialSmoothing::operator()(const ImageBuffer& source, ImageBuffer& out, SimdPath path) {
  const auto smooth = path == SimdPath::Avx2 ? smoothRowAvx2 : smoothRowPortable;
  const int last = source.height() - 1;
  for (int y = 0; y <= last; ++y)
    smooth(source.row(std::max(y - 1, 0)), source.row(y), source.row(std::min(y + 1, last)),
           source.width(), row_.data() + kAlign, out.row(y));
}

}  // namespace depthscope::slam
