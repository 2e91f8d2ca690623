#include "slam/fast_detector.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace depthscope::slam {
namespace {

using Byte = std::uint8_t;

DEPTHSCOPE_KERNEL Byte lower(Byte a, Byte b) {
  return a < b ? a : b;
}
DEPTHSCOPE_KERNEL Byte upper(Byte a, Byte b) {
  return a > b ? a : b;
}
/// a - b, but not below 0.
DEPTHSCOPE_KERNEL Byte excess(Byte a, Byte b) {
  return static_cast<Byte>(upper(a, b) - b);
}

/// Offsets of the 16 pixels of the circle, in order around it.
DEPTHSCOPE_KERNEL std::array<std::ptrdiff_t, 16> circleOffsets(std::ptrdiff_t stride) {
  constexpr std::array<int, 16> kX{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<int, 16> kY{-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  std::array<std::ptrdiff_t, 16> offsets{};
  for (int k = 0; k < 16; ++k) offsets[k] = kY[k] * stride + kX[k];
  return offsets;
}

/// The score from the 16 pixels of the circle. The two arcs of nine that share the eight pixels
/// k+1..k+8 are taken together: best of (min8, end k) and (min8, end k+9) = min(min8, max(ends)).
DEPTHSCOPE_KERNEL Byte scoreOf(const std::array<Byte, 16>& ring, Byte centre) {
  Byte low2[8], low4[8], high2[8], high4[8];
  for (int i = 0; i < 8; ++i) {
    const Byte a = ring[2 * i + 1], b = ring[(2 * i + 2) % 16];
    low2[i] = lower(a, b);
    high2[i] = upper(a, b);
  }
  for (int i = 0; i < 8; ++i) {
    low4[i] = lower(low2[i], low2[(i + 1) % 8]);
    high4[i] = upper(high2[i], high2[(i + 1) % 8]);
  }
  Byte brightest = 0, darkest = 255;
  for (int i = 0; i < 8; ++i) {
    const Byte a = ring[2 * i], b = ring[(2 * i + 9) % 16];
    brightest = upper(brightest, lower(lower(low4[i], low4[(i + 2) % 8]), upper(a, b)));
    darkest = lower(darkest, upper(upper(high4[i], high4[(i + 2) % 8]), lower(a, b)));
  }
  return upper(excess(brightest, centre), excess(centre, darkest));
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

template <int Width>
DEPTHSCOPE_KERNEL void scoreBlock(const Byte* p, const std::array<std::ptrdiff_t, 16>& o,
                                  Byte threshold, Byte* score) {
  for (int i = 0; i < Width; ++i) {
    std::array<Byte, 16> ring;
    for (int k = 0; k < 16; ++k) ring[k] = p[o[k] + i];
    const Byte s = scoreOf(ring, p[i]);
    score[i] = s > threshold ? s : Byte{0};
  }
}

template <int Width>
DEPTHSCOPE_KERNEL bool anySet(const Byte* p) {
  std::uint64_t words[Width / 8];
  std::memcpy(words, p, Width);
  std::uint64_t any = 0;
  for (const std::uint64_t w : words) any |= w;
  return any != 0;
}

/// Scores of the pixels begin..end-1 of a row; zero where not above the threshold. May write up to
/// a block beyond `end`.
template <int Width>
DEPTHSCOPE_KERNEL void scoreRowKernel(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                                      Byte threshold, Byte* mark, Byte* score) {
  const auto offsets = circleOffsets(stride);
  markCandidates(row, stride, begin, (end - begin + Width - 1) / Width * Width + begin, threshold,
                 mark);
  for (int x = begin; x < end; x += Width) {
    if (anySet<Width>(mark + x))
      scoreBlock<Width>(row + x, offsets, threshold, score + x);
    else
      std::memset(score + x, 0, Width);
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
    const Byte rival = upper(before, excess(after, 1));
    maxima[x] = s > rival ? s : Byte{0};
  }
}

struct Kernels {
  void (*score)(const Byte*, std::ptrdiff_t, int, int, Byte, Byte*, Byte*);
  void (*suppress)(const Byte*, const Byte*, const Byte*, int, int, Byte*);
};

void scorePortable(const Byte* row, std::ptrdiff_t stride, int begin, int end, Byte threshold,
                   Byte* mark, Byte* score) {
  scoreRowKernel<16>(row, stride, begin, end, threshold, mark, score);
}
void suppressPortable(const Byte* above, const Byte* row, const Byte* below, int begin, int end,
                      Byte* maxima) {
  suppressKernel(above, row, below, begin, end, maxima);
}

#if DEPTHSCOPE_HAS_AVX2
DEPTHSCOPE_AVX2 void scoreAvx2(const Byte* row, std::ptrdiff_t stride, int begin, int end,
                               Byte threshold, Byte* mark, Byte* score) {
  scoreRowKernel<32>(row, stride, begin, end, threshold, mark, score);
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
  const auto offsets = circleOffsets(stride);
  std::array<Byte, 16> ring;
  for (int k = 0; k < 16; ++k) ring[k] = centre[offsets[k]];
  return scoreOf(ring, *centre);
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
