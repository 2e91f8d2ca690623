#include "capture/pixel_rows.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "types/vector_clones.hpp"

namespace depthscope::capture {

namespace {

static_assert(std::endian::native == std::endian::little, "pixels are packed into 32-bit words");

constexpr int kHalf = 1 << (kFractionBits - 1);
constexpr std::uint32_t kOpaque = 0xff000000u;

}  // namespace

DEPTHSCOPE_CLONES
void duplicate(const std::uint8_t* __restrict chroma, int samples, std::uint8_t* __restrict out) {
  for (int i = 0; i < samples; ++i) out[2 * i] = out[2 * i + 1] = chroma[i];
}

DEPTHSCOPE_CLONES
void duplicateInterleaved(const std::uint8_t* __restrict uv, int samples,
                          std::uint8_t* __restrict u, std::uint8_t* __restrict v) {
  for (int i = 0; i < samples; ++i) {
    u[2 * i] = u[2 * i + 1] = uv[2 * i];
    v[2 * i] = v[2 * i + 1] = uv[2 * i + 1];
  }
}

DEPTHSCOPE_CLONES
void yuvToRgba(const std::uint8_t* __restrict y, const std::uint8_t* __restrict u,
               const std::uint8_t* __restrict v, int pixels, const YuvCoefficients& coefficient,
               std::uint8_t* __restrict out) {
  const YuvCoefficients c = coefficient;
  for (int x = 0; x < pixels; ++x) {
    const int luma = c.y * (y[x] - c.y_offset) + kHalf;
    const int du = u[x] - 128, dv = v[x] - 128;
    const int red = (luma + c.v_red * dv) >> kFractionBits;
    const int green = (luma + c.u_green * du + c.v_green * dv) >> kFractionBits;
    const int blue = (luma + c.u_blue * du) >> kFractionBits;
    const auto r = static_cast<std::uint32_t>(std::clamp(red, 0, 255));
    const auto g = static_cast<std::uint32_t>(std::clamp(green, 0, 255));
    const auto b = static_cast<std::uint32_t>(std::clamp(blue, 0, 255));
    const std::uint32_t word = r | g << 8 | b << 16 | kOpaque;
    std::memcpy(out + 4 * x, &word, 4);
  }
}

DEPTHSCOPE_CLONES
void grayToRgba(const std::uint8_t* __restrict y, int pixels, const YuvCoefficients& coefficient,
                std::uint8_t* __restrict out) {
  const YuvCoefficients c = coefficient;
  for (int x = 0; x < pixels; ++x) {
    const int luma = (c.y * (y[x] - c.y_offset) + kHalf) >> kFractionBits;
    const std::uint32_t word = static_cast<std::uint32_t>(std::clamp(luma, 0, 255)) * 0x010101u;
    const std::uint32_t pixel = word | kOpaque;
    std::memcpy(out + 4 * x, &pixel, 4);
  }
}

DEPTHSCOPE_CLONES
void rgb24ToRgba(const std::uint8_t* __restrict rgb, int pixels, int red_at, int blue_at,
                 std::uint8_t* __restrict out) {
  for (int x = 0; x < pixels; ++x) {
    out[4 * x + 0] = rgb[3 * x + red_at];
    out[4 * x + 1] = rgb[3 * x + 1];
    out[4 * x + 2] = rgb[3 * x + blue_at];
    out[4 * x + 3] = 255;
  }
}

DEPTHSCOPE_CLONES
void bgrxToRgba(const std::uint8_t* __restrict bgrx, int pixels, std::uint8_t* __restrict out) {
  for (int x = 0; x < pixels; ++x) {
    std::uint32_t word = 0;
    std::memcpy(&word, bgrx + 4 * x, 4);
    word = (word & 0xff00u) | (word >> 16 & 0xffu) | (word & 0xffu) << 16 | kOpaque;
    std::memcpy(out + 4 * x, &word, 4);
  }
}

DEPTHSCOPE_CLONES
void rgba32ToRgba(const std::uint8_t* __restrict rgba, int pixels, std::uint8_t* __restrict out) {
  for (int x = 0; x < pixels; ++x) {
    std::uint32_t word = 0;
    std::memcpy(&word, rgba + 4 * x, 4);
    word |= kOpaque;
    std::memcpy(out + 4 * x, &word, 4);
  }
}

DEPTHSCOPE_CLONES
void rgbToGray(const std::uint8_t* __restrict rgb, int pixels, int bytes_per_pixel, int red_at,
               int blue_at, std::uint8_t* __restrict out) {
  constexpr int kRed = fixedPoint(0.299), kGreen = fixedPoint(0.587), kBlue = fixedPoint(0.114);
  static_assert(kRed + kGreen + kBlue == 1 << kFractionBits);
  for (int x = 0; x < pixels; ++x) {
    const std::uint8_t* p = rgb + bytes_per_pixel * x;
    const int sum = kRed * p[red_at] + kGreen * p[1] + kBlue * p[blue_at] + kHalf;
    out[x] = static_cast<std::uint8_t>(sum >> kFractionBits);
  }
}

DEPTHSCOPE_CLONES
void expandRgba(int pixels, std::uint8_t* rgba) {
  constexpr int kScale = fixedPoint(255.0 / 219.0);
  for (int i = 0; i < 4 * pixels; ++i) {
    const int level = std::clamp((kScale * (rgba[i] - 16) + kHalf) >> kFractionBits, 0, 255);
    rgba[i] = static_cast<std::uint8_t>(i % 4 == 3 ? 255 : level);
  }
}

DEPTHSCOPE_CLONES
void unpack422(const std::uint8_t* __restrict packed, int pixels, int luma_at,
               std::uint8_t* __restrict y, std::uint8_t* __restrict u, std::uint8_t* __restrict v) {
  const std::uint8_t* chroma = packed + 1 - luma_at;
  packed += luma_at;
  for (int i = 0; i < (pixels + 1) / 2; ++i) {
    y[2 * i] = packed[4 * i];
    y[2 * i + 1] = packed[4 * i + 2];
    u[2 * i] = u[2 * i + 1] = chroma[4 * i];
    v[2 * i] = v[2 * i + 1] = chroma[4 * i + 2];
  }
}

DEPTHSCOPE_CLONES
void lumaOf422(const std::uint8_t* __restrict packed, int pixels, int luma_at,
               std::uint8_t* __restrict y) {
  packed += luma_at;
  for (int x = 0; x < pixels; ++x) y[x] = packed[2 * x];
}

}  // namespace depthscope::capture
