#include "slam/fast_detector.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace depthscope::slam {
namespace {

#pragma GCC diagnostic ignored "-Wpsabi"
using Byte = std::uint8_t;
/// 16 or 32 pixels side by side, worked on together.
using Bytes16 = Byte __attribute__((vector_size(16)));
using Bytes32 = Byte __attribute__((vector_size(32)));

// Each for one pixel or for a vector of them; passed by reference since how vectors are passed by
// value depends on the instruction set.
template <class V>
DEPTHSCOPE_KERNEL void load(const Byte* from, V& to) {
  std::memcpy(&to, from, sizeof(V));
}
template <class V>
DEPTHSCOPE_KERNEL V lower(const V& a, const V& b) {
  return a < b ? a : b;
}
template <class V>
DEPTHSCOPE_KERNEL V upper(const V& a, const V& b) {
  return a > b ? a : b;
}
/// a - b, but not below 0.
template <class V>
DEPTHSCOPE_KERNEL V excess(const V& a, const V& b) {
  return static_cast<V>(upper(a, b) - b);
}

/// Offsets of the 16 pixels of the circle, in order around it.
DEPTHSCOPE_KERNEL std::array<std::ptrdiff_t, 16> circleOffsets(std::ptrdiff_t stride) {
  constexpr std::array<int, 16> kX{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<int, 16> kY{-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  std::array<std::ptrdiff_t, 16> offsets{};
  for (int k = 0; k < 16; ++k) offsets[k] = kY[k] * stride + kX[k];
  return offsets;
}

/// The score at `p`. The two arcs of nine that share the eight pixels k+1..k+8 are taken together:
/// best of (min8, end k) and (min8, end k+9) = min(min8, max(ends)).
template <class V>
DEPTHSCOPE_KERNEL void scoreAt(const Byte* p, const std::array<std::ptrdiff_t, 16>& offsets,
                               V& score) {
  V ring[16], low2[8], high2[8], low4[8], high4[8], centre;
  load(p, centre);
  for (int k = 0; k < 16; ++k) load(p + offsets[k], ring[k]);
  for (int i = 0; i < 8; ++i) {
    low2[i] = lower(ring[2 * i + 1], ring[(2 * i + 2) % 16]);
    high2[i] = upper(ring[2 * i + 1], ring[(2 * i + 2) % 16]);
  }
  for (int i = 0; i < 8; ++i) {
    low4[i] = lower(low2[i], low2[(i + 1) % 8]);
    high4[i] = upper(high2[i], high2[(i + 1) % 8]);
  }
  V brightest = centre, darkest = centre;  // so that neither difference is below zero
  for (int i = 0; i < 8; ++i) {
    const V &a = ring[2 * i], &b = ring[(2 * i + 9) % 16];
    brightest = upper(brightest, lower(lower(low4[i], low4[(i + 2) % 8]), upper(a, b)));
    darkest = lower(darkest, upper(upper(high4[i], high4[(i + 2) % 8]), lower(a, b)));
  }
  score = upper(static_cast<V>(brightest - centre), static_cast<V>(centre - darkest));
}

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

int fastScore(const std::uint8_t* centre, std::ptrdiff_t stride) {
  Byte score = 0;
  scoreAt(centre, circleOffsets(stride), score);
  return score;
}

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
