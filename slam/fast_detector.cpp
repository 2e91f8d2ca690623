#include "slam/fast_detector.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "slam/fast_score.hpp"

namespace depthscope::slam {
namespace {

using namespace fast;

/// Can a pixel at `p` have a score above `threshold`? Of any two opposite pixels of the circle at
/// least one lies on an arc of nine, so that the weaker of both bounds the score.
template <class V>
DEPTHSCOPE_KERNEL bool mayScore(const Byte* p, const std::array<std::ptrdiff_t, 16>& offsets,
                                const V& thresholds) {
  V centre, a, b;
  load(p, centre);
  load(p + offsets[0], a);
  load(p + offsets[8], b);
  V brightest = upper(a, b), darkest = lower(a, b);
  for (int k = 2; k < 8; k += 2) {
    load(p + offsets[k], a);
    load(p + offsets[k + 8], b);
    brightest = lower(brightest, upper(a, b));
    darkest = upper(darkest, lower(a, b));
  }
  const V bound = upper(excess(brightest, centre), excess(centre, darkest));
  const V above = excess(bound, thresholds);
  std::uint64_t words[sizeof(V) / 8];
  std::memcpy(words, &above, sizeof(V));
  std::uint64_t any = 0;
  for (const std::uint64_t w : words) any |= w;
  return any != 0;
}

/// Scores of the pixels begin..end-1 of a row; zero where not above the threshold. May write up to
/// a vector beyond `end`.
template <class V>
DEPTHSCOPE_KERNEL void scoreRowKernel(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                                      Byte threshold, Byte* score) {
  constexpr int kWidth = sizeof(V);
  const auto offsets = circleOffsets(stride);
  const V thresholds = V{} + threshold;
  for (int x = begin; x < end; x += kWidth) {
    V scores{};
    if (mayScore(row + x, offsets, thresholds)) {
      scoreAt(row + x, offsets, scores);
      scores = scores > thresholds ? scores : V{};
    }
    std::memcpy(score + x, &scores, kWidth);
  }
}

/// Keeps the scores that are maxima of their neighbourhood, zero elsewhere.
DEPTHSCOPE_KERNEL void suppressKernel(const Byte* above, const Byte* row, const Byte* below,
                                      int begin, int end, Byte* maxima) {
  for (int x = begin; x < end; ++x) {
    const Byte before = upper(upper(above[x - 1], above[x]), upper(above[x + 1], row[x - 1]));
    const Byte after = upper(upper(below[x - 1], below[x]), upper(below[x + 1], row[x + 1]));
    const Byte s = row[x];
    // Unsigned bytes: s > before and s >= after, without branches.
    const Byte rival = upper(before, excess(after, Byte{1}));
    maxima[x] = s > rival ? s : Byte{0};
  }
}

struct Kernels {
  void (*score)(const Byte*, std::ptrdiff_t, int, int, Byte, Byte*);
  void (*suppress)(const Byte*, const Byte*, const Byte*, int, int, Byte*);
};

void scorePortable(const Byte* row, std::ptrdiff_t stride, int begin, int end, Byte threshold,
                   Byte* score) {
  scoreRowKernel<Bytes16>(row, stride, begin, end, threshold, score);
}
void suppressPortable(const Byte* above, const Byte* row, const Byte* below, int begin, int end,
                      Byte* maxima) {
  suppressKernel(above, row, below, begin, end, maxima);
}

#if DEPTHSCOPE_HAS_AVX2
DEPTHSCOPE_AVX2 void scoreAvx2(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                               Byte threshold, Byte* score) {
  scoreRowKernel<Bytes32>(row, stride, begin, end, threshold, score);
}
DEPTHSCOPE_AVX2 void suppressAvx2(const Byte* above, const Byte* row, const Byte* below, int begin,
                                  int end, Byte* maxima) {
  suppressKernel(above, row, below, begin, end, maxima);
}
#endif

Kernels kernelsFor([[maybe_unused]] SimdPath path) {
#if DEPTHSCOPE_HAS_AVX2
  if (path == SimdPath::Avx2) return {scoreAvx2, suppressAvx2};
#endif
  return {scorePortable, suppressPortable};
}

/// `maxima` is zero behind `end` up to the next multiple of eight from `begin`.
void appendMaxima(const Byte* maxima, int begin, int end, int y, std::vector<Corner>& corners) {
  static_assert(std::endian::native == std::endian::little);
  for (int x = begin; x < end; x += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, maxima + x, 8);
    while (word != 0) {
      const int i = std::countr_zero(word) / 8;
      corners.push_back({static_cast<std::int16_t>(x + i), static_cast<std::int16_t>(y),
                         static_cast<std::uint8_t>(word >> (8 * i))});
      word &= ~(std::uint64_t{255} << (8 * i));
    }
  }
}

}  // namespace

FastDetector::FastDetector(int width)
    : stride_((width + 191) / 64 * 64), scores_(3 * stride_), row_(stride_) {}

void FastDetector::detect(const ImageBuffer& image, int threshold, const Area& area, SimdPath path,
                          std::vector<Corner>& corners) {
  if (area.right <= area.left || area.bottom <= area.top) return;
  const Kernels kernels = kernelsFor(path);
  const auto t = static_cast<Byte>(std::clamp(threshold, 1, 254));
  std::fill_n(row_.begin() + area.right, 8, Byte{0});
  // One pixel more on each side is scored, as neighbours only.
  for (int y = area.top - 1; y <= area.bottom; ++y) {
    kernels.score(image.row(y), image.stride(), area.left - 1, area.right + 1, t, scoreRow(y));
    if (y <= area.top) continue;
    kernels.suppress(scoreRow(y - 2), scoreRow(y - 1), scoreRow(y), area.left, area.right,
                     row_.data());
    appendMaxima(row_.data(), area.left, area.right, y - 1, corners);
  }
}

}  // namespace depthscope::slam
