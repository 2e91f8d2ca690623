#include "slam/fast_detector.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "slam/fast_score.hpp"

namespace depthscope::slam {
namespace {

using namespace fast;

/// Marks with non-zero the pixels that may have a score above `threshold`: of any two opposite
/// pixels of the circle at least one lies on an arc of nine.
DEPTHSCOPE_KERNEL void markCandidates(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                                      Byte threshold, Byte* mark) {
  const auto o = circleOffsets(stride);
  for (int x = begin; x < end; ++x) {
    const Byte* p = row + x;
    Byte brightest = 255, darkest = 0;
    for (int k = 0; k < 8; k += 2) {
      brightest = lower(brightest, upper(p[o[k]], p[o[k + 8]]));
      darkest = upper(darkest, lower(p[o[k]], p[o[k + 8]]));
    }
    const Byte c = *p;
    mark[x] = excess(upper(excess(brightest, c), excess(c, darkest)), threshold);
  }
}

template <class V>
DEPTHSCOPE_KERNEL bool anySet(const Byte* p) {
  std::uint64_t words[sizeof(V) / 8];
  std::memcpy(words, p, sizeof(V));
  std::uint64_t any = 0;
  for (const std::uint64_t w : words) any |= w;
  return any != 0;
}

/// Scores of the pixels begin..end-1 of a row; zero where not above the threshold. May write up to
/// a vector beyond `end`.
template <class V>
DEPTHSCOPE_KERNEL void scoreRowKernel(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                                      Byte threshold, Byte* mark, Byte* score) {
  constexpr int kWidth = sizeof(V);
  const auto offsets = circleOffsets(stride);
  const V thresholds = V{} + threshold;
  markCandidates(row, stride, begin, (end - begin + kWidth - 1) / kWidth * kWidth + begin,
                 threshold, mark);
  for (int x = begin; x < end; x += kWidth) {
    V scores{};
    if (anySet<V>(mark + x)) {
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
  void (*score)(const Byte*, std::ptrdiff_t, int, int, Byte, Byte*, Byte*);
  void (*suppress)(const Byte*, const Byte*, const Byte*, int, int, Byte*);
};

void scorePortable(const Byte* row, std::ptrdiff_t stride, int begin, int end, Byte threshold,
                   Byte* mark, Byte* score) {
  scoreRowKernel<Bytes16>(row, stride, begin, end, threshold, mark, score);
}
void suppressPortable(const Byte* above, const Byte* row, const Byte* below, int begin, int end,
                      Byte* maxima) {
  suppressKernel(above, row, below, begin, end, maxima);
}

#if DEPTHSCOPE_HAS_AVX2
DEPTHSCOPE_AVX2 void scoreAvx2(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                               Byte threshold, Byte* mark, Byte* score) {
  scoreRowKernel<Bytes32>(row, stride, begin, end, threshold, mark, score);
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

void appendMaxima(const Byte* maxima, int begin, int end, int y, std::vector<Corner>& corners) {
  for (int x = begin; x < end; x += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, maxima + x, 8);
    if (word == 0) continue;
    for (int i = x; i < std::min(x + 8, end); ++i)
      if (maxima[i] != 0)
        corners.push_back({static_cast<std::int16_t>(i), static_cast<std::int16_t>(y), maxima[i]});
  }
}

}  // namespace

FastDetector::FastDetector(int width)
    : stride_((width + 191) / 64 * 64), scores_(3 * stride_), row_(stride_) {}

void FastDetector::detect(const ImageBuffer& image, int threshold, int margin, SimdPath path,
                          std::vector<Corner>& corners) {
  const Kernels kernels = kernelsFor(path);
  const auto t = static_cast<Byte>(std::clamp(threshold, 1, 254));
  const int begin = margin, end = image.width() - margin;
  // One pixel more on each side is scored, as neighbours only.
  for (int y = margin - 1; y <= image.height() - margin; ++y) {
    kernels.score(image.row(y), image.stride(), begin - 1, end + 1, t, row_.data(), scoreRow(y));
    if (y <= margin) continue;
    kernels.suppress(scoreRow(y - 2), scoreRow(y - 1), scoreRow(y), begin, end, row_.data());
    appendMaxima(row_.data(), begin, end, y - 1, corners);
  }
}

}  // namespace depthscope::slam
