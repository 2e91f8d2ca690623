#include "capture/pixel_convert.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

// One clone for AVX2, chosen when the program is loaded. Integer code only: both give the same
// bits. The sanitizers' run-times are not up yet when such a choice is made, so they get the plain
// function.
#if defined(__x86_64__) && !defined(DEPTHSCOPE_SANITIZED)
#define DEPTHSCOPE_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define DEPTHSCOPE_CLONES
#endif

namespace depthscope::capture {

namespace {

static_assert(std::endian::native == std::endian::little, "pixels are packed into 32-bit words");

constexpr int kFractionBits = 16;
constexpr int kHalf = 1 << (kFractionBits - 1);
constexpr std::uint32_t kOpaque = 0xff000000u;
constexpr int kBlock_px = 512;  // even; a block's chroma stays in the first-level cache

constexpr int fixedPoint(double value) {
  return static_cast<int>(value * (1 << kFractionBits) + (value < 0 ? -0.5 : 0.5));
}

struct YuvCoefficients {
  int y_offset = 0;
  int y = 0;  // 16 fractional bits, as are all below
  int v_red = 0;
  int u_green = 0, v_green = 0;
  int u_blue = 0;
};

constexpr YuvCoefficients coefficients(double k_red, double k_blue, YuvRange range) {
  const bool limited = range == YuvRange::Limited;
  const double y_scale = limited ? 255.0 / 219.0 : 1.0;
  const double c_scale = limited ? 255.0 / 224.0 : 1.0;
  const double k_green = 1.0 - k_red - k_blue;
  const double v_red = 2.0 * (1.0 - k_red) * c_scale;
  const double u_blue = 2.0 * (1.0 - k_blue) * c_scale;
  return {limited ? 16 : 0,
          fixedPoint(y_scale),
          fixedPoint(v_red),
          fixedPoint(-u_blue * k_blue / k_green),
          fixedPoint(-v_red * k_red / k_green),
          fixedPoint(u_blue)};
}

constexpr YuvCoefficients kBt601Limited = coefficients(0.299, 0.114, YuvRange::Limited);
constexpr YuvCoefficients kBt601Full = coefficients(0.299, 0.114, YuvRange::Full);
constexpr YuvCoefficients kBt709Limited = coefficients(0.2126, 0.0722, YuvRange::Limited);
constexpr YuvCoefficients kBt709Full = coefficients(0.2126, 0.0722, YuvRange::Full);

const YuvCoefficients& coefficientsOf(const FrameFormat& format) {
  const bool limited = format.range == YuvRange::Limited;
  if (format.matrix == YuvMatrix::Bt709) return limited ? kBt709Limited : kBt709Full;
  return limited ? kBt601Limited : kBt601Full;
}

/// Each chroma sample twice: `samples` of them give 2 * samples values.
DEPTHSCOPE_CLONES
void duplicate(const std::uint8_t* __restrict chroma, int samples, std::uint8_t* __restrict out) {
  for (int i = 0; i < samples; ++i) out[2 * i] = out[2 * i + 1] = chroma[i];
}

/// The same for interleaved U V U V.
DEPTHSCOPE_CLONES
void duplicateInterleaved(const std::uint8_t* __restrict uv, int samples,
                          std::uint8_t* __restrict u, std::uint8_t* __restrict v) {
  for (int i = 0; i < samples; ++i) {
    u[2 * i] = u[2 * i + 1] = uv[2 * i];
    v[2 * i] = v[2 * i + 1] = uv[2 * i + 1];
  }
}

/// One U and one V for each Y. Whole 32-bit words are written, so that no lane has to cross.
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
void rgba32ToRgba(const std::uint8_t* __restrict rgba, int pixels, std::uint8_t* __restrict out) {
  for (int x = 0; x < pixels; ++x) {
    std::uint32_t word = 0;
    std::memcpy(&word, rgba + 4 * x, 4);
    word |= kOpaque;
    std::memcpy(out + 4 * x, &word, 4);
  }
}

/// BT.601 luma of full-range RGB, weights with 16 fractional bits that add up to one.
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

/// One row of a YUV frame, block by block.
void yuvRowToRgba(const Frame& frame, int row, const YuvCoefficients& c, std::uint8_t* out) {
  alignas(64) std::uint8_t u[kBlock_px], v[kBlock_px];
  const bool interleaved = frame.format.pixel_format == PixelFormat::Nv12;
  const auto rowOf = [&](int plane, int r) {
    return frame.planes[plane].data + r * frame.planes[plane].stride;
  };
  for (int x = 0; x < frame.format.width; x += kBlock_px) {
    const int pixels = std::min(kBlock_px, frame.format.width - x);
    const int samples = (pixels + 1) / 2;
    if (interleaved) {
      duplicateInterleaved(rowOf(1, row / 2) + x, samples, u, v);
    } else {
      duplicate(rowOf(1, row / 2) + x / 2, samples, u);
      duplicate(rowOf(2, row / 2) + x / 2, samples, v);
    }
    yuvToRgba(rowOf(0, row) + x, u, v, pixels, c, out + std::ptrdiff_t{4} * x);
  }
}

bool fits(const Frame& frame, std::span<std::uint8_t> out, std::size_t bytes_per_pixel) {
  return !frame.empty() && out.size() >= static_cast<std::size_t>(frame.format.width) *
                                             static_cast<std::size_t>(frame.format.height) *
                                             bytes_per_pixel;
}

}  // namespace

void toRgba(const Frame& frame, std::span<std::uint8_t> out) {
  if (!fits(frame, out, 4)) return;
  const int width = frame.format.width;
  const YuvCoefficients& c = coefficientsOf(frame.format);
  for (int row = 0; row < frame.format.height; ++row) {
    const std::uint8_t* in = frame.planes[0].data + row * frame.planes[0].stride;
    std::uint8_t* to = out.data() + std::ptrdiff_t{4} * row * width;
    switch (frame.format.pixel_format) {
      case PixelFormat::Gray8:
        grayToRgba(in, width, c, to);
        break;
      case PixelFormat::Rgb24:
        rgb24ToRgba(in, width, 0, 2, to);
        break;
      case PixelFormat::Bgr24:
        rgb24ToRgba(in, width, 2, 0, to);
        break;
      case PixelFormat::Rgba32:
        rgba32ToRgba(in, width, to);
        break;
      case PixelFormat::Yuv420p:
      case PixelFormat::Nv12:
        yuvRowToRgba(frame, row, c, to);
        break;
    }
  }
}

void toGray(const Frame& frame, std::span<std::uint8_t> out) {
  if (!fits(frame, out, 1)) return;
  const int width = frame.format.width;
  for (int row = 0; row < frame.format.height; ++row) {
    const std::uint8_t* in = frame.planes[0].data + row * frame.planes[0].stride;
    std::uint8_t* to = out.data() + std::ptrdiff_t{1} * row * width;
    switch (frame.format.pixel_format) {
      case PixelFormat::Gray8:
      case PixelFormat::Yuv420p:
      case PixelFormat::Nv12:
        std::memcpy(to, in, static_cast<std::size_t>(width));
        break;
      case PixelFormat::Rgb24:
        rgbToGray(in, width, 3, 0, 2, to);
        break;
      case PixelFormat::Bgr24:
        rgbToGray(in, width, 3, 2, 0, to);
        break;
      case PixelFormat::Rgba32:
        rgbToGray(in, width, 4, 0, 2, to);
        break;
    }
  }
}

}  // namespace depthscope::capture
