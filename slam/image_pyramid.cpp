#include "slam/image_pyramid.hpp"

#include <algorithm>
#include <cmath>

#if defined(__SSSE3__)
#include <tmmintrin.h>
#endif

namespace depthscope::slam {
namespace {

/// out = (1 - weight / 64) * a + weight / 64 * b, rounded.
DEPTHSCOPE_KERNEL void blendRows(const std::uint8_t* a, const std::uint8_t* b, int weight,
                                 int width, std::uint8_t* out) {
  const auto wa = static_cast<std::uint16_t>(64 - weight), wb = static_cast<std::uint16_t>(weight);
  for (int x = 0; x < width; ++x)
    out[x] = static_cast<std::uint8_t>(static_cast<std::uint16_t>(a[x] * wa + b[x] * wb + 32) >> 6);
}

void blendRowsPortable(const std::uint8_t* a, const std::uint8_t* b, int weight, int width,
                       std::uint8_t* out) {
  blendRows(a, b, weight, width, out);
}

#if DEPTHSCOPE_HAS_AVX2
DEPTHSCOPE_AVX2 void blendRowsAvx2(const std::uint8_t* a, const std::uint8_t* b, int weight,
                                   int width, std::uint8_t* out) {
  blendRows(a, b, weight, width, out);
}
#else
constexpr auto blendRowsAvx2 = blendRowsPortable;
#endif

}  // namespace

BilinearShrink::Tap BilinearShrink::tapAt(int i, double factor, int source_size) {
  const double position = std::clamp((i + 0.5) * factor - 0.5, 0.0, source_size - 1.0);
  const int fixed = static_cast<int>(std::lround(position * 64));
  const int first = std::min(fixed / 64, source_size - 2);
  return {first, static_cast<std::uint8_t>(fixed - first * 64)};
}

BilinearShrink::BilinearShrink(int source_width, int source_height, int width, int height,
                               double factor)
    : blended_((source_width + 127) / 64 * 64) {
  for (int y = 0; y < height; ++y) rows_.push_back(tapAt(y, factor, source_height));
  for (int x = 0; x < width; x += 8) {
    ColumnGroup group{tapAt(x, factor, source_width).first, {}, {}};
    for (int i = 0; i < 8; ++i) {
      const Tap tap = tapAt(std::min(x + i, width - 1), factor, source_width);
      group.select[2 * i] = static_cast<std::uint8_t>(tap.first - group.first);
      group.select[2 * i + 1] = static_cast<std::uint8_t>(tap.first + 1 - group.first);
      group.weights[2 * i] = static_cast<std::int8_t>(64 - tap.weight);
      group.weights[2 * i + 1] = static_cast<std::int8_t>(tap.weight);
    }
    columns_.push_back(group);
  }
}

void BilinearShrink::shrinkRow(std::uint8_t* out) const {
  for (const ColumnGroup& group : columns_) {
    const std::uint8_t* source = blended_.data() + group.first;
#if defined(__SSSE3__)
    const __m128i pairs =
        _mm_shuffle_epi8(_mm_loadu_si128(reinterpret_cast<const __m128i*>(source)),
                         _mm_load_si128(reinterpret_cast<const __m128i*>(group.select.data())));
    const __m128i sums = _mm_maddubs_epi16(
        pairs, _mm_load_si128(reinterpret_cast<const __m128i*>(group.weights.data())));
    const __m128i rounded = _mm_srli_epi16(_mm_add_epi16(sums, _mm_set1_epi16(32)), 6);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(out), _mm_packus_epi16(rounded, rounded));
#else
    for (int i = 0; i < 8; ++i)
      out[i] = static_cast<std::uint8_t>(
          (source[group.select[2 * i]] * group.weights[2 * i] +
           source[group.select[2 * i + 1]] * group.weights[2 * i + 1] + 32) >>
          6);
#endif
    out += 8;
  }
}

void BilinearShrink::operator()(const ImageBuffer& source, ImageBuffer& out, SimdPath path) {
  const auto blend = path == SimdPath::Avx2 ? blendRowsAvx2 : blendRowsPortable;
  for (int y = 0; y < out.height(); ++y) {
    const Tap& tap = rows_[y];
    blend(source.row(tap.first), source.row(tap.first + 1), tap.weight, source.width(),
          blended_.data());
    shrinkRow(out.row(y));
  }
}

ImagePyramid::ImagePyramid(int width, int height, int levels, double scale_factor) {
  for (int l = 0; l < levels; ++l) {
    scales_.push_back(std::pow(scale_factor, l));
    const int w = static_cast<int>(std::lround(width / scales_[l]));
    const int h = static_cast<int>(std::lround(height / scales_[l]));
    if (l > 0)
      shrinks_.emplace_back(images_.back().width(), images_.back().height(), w, h, scale_factor);
    images_.emplace_back(w, h);
  }
}

void ImagePyramid::build(const GrayView& image, SimdPath path) {
  images_[0].assign(image);
  for (int l = 1; l < levels(); ++l) shrinks_[l - 1](images_[l - 1], images_[l], path);
}

}  // namespace depthscope::slam
