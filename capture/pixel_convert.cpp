#include "capture/pixel_convert.hpp"

#include <algorithm>
#include <cstring>

namespace depthscope::capture {

namespace {

constexpr int kBlock_px = 512;  // even; a block's samples stay in the first-level cache

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

// By YuvMatrix, then YuvRange.
constexpr YuvCoefficients kCoefficients[3][2] = {
    {coefficients(0.299, 0.114, YuvRange::Limited), coefficients(0.299, 0.114, YuvRange::Full)},
    {coefficients(0.2126, 0.0722, YuvRange::Limited), coefficients(0.2126, 0.0722, YuvRange::Full)},
    {coefficients(0.2627, 0.0593, YuvRange::Limited), coefficients(0.2627, 0.0593, YuvRange::Full)},
};

/// One row of a YUV frame, block by block.
void yuvRowToRgba(const Frame& frame, int row, const YuvCoefficients& c, std::uint8_t* out) {
  alignas(64) std::uint8_t luma[kBlock_px], u[kBlock_px], v[kBlock_px];
  const PixelFormat format = frame.format.pixel_format;
  const bool half_height = format == PixelFormat::Yuv420p || format == PixelFormat::Nv12;
  const auto at = [&](int plane, int offset) {
    const int r = plane > 0 && half_height ? row / 2 : row;
    return frame.planes[plane].data + r * frame.planes[plane].stride + offset;
  };
  for (int x = 0; x < frame.format.width; x += kBlock_px) {
    const int pixels = std::min(kBlock_px, frame.format.width - x);
    const int samples = (pixels + 1) / 2;
    std::uint8_t* const to = out + std::ptrdiff_t{4} * x;
    switch (format) {
      case PixelFormat::Yuyv:
      case PixelFormat::Uyvy:
        unpack422(at(0, 2 * x), pixels, format == PixelFormat::Uyvy, luma, u, v);
        yuvToRgba(luma, u, v, pixels, c, to);
        break;
      case PixelFormat::Nv12:
      case PixelFormat::Nv16:
        duplicateInterleaved(at(1, x), samples, u, v);
        yuvToRgba(at(0, x), u, v, pixels, c, to);
        break;
      case PixelFormat::Yuv444p:
        yuvToRgba(at(0, x), at(1, x), at(2, x), pixels, c, to);
        break;
      default:  // Yuv420p and Yuv422p
        duplicate(at(1, x / 2), samples, u);
        duplicate(at(2, x / 2), samples, v);
        yuvToRgba(at(0, x), u, v, pixels, c, to);
    }
  }
}

bool fits(const Frame& frame, std::span<std::uint8_t> out, std::size_t bytes_per_pixel) {
  return !frame.empty() && out.size() >= static_cast<std::size_t>(frame.format.width) *
                                             static_cast<std::size_t>(frame.format.height) *
                                             bytes_per_pixel;
}

bool isRgb(PixelFormat format) {
  return format == PixelFormat::Rgb24 || format == PixelFormat::Bgr24 ||
         format == PixelFormat::Rgba32 || format == PixelFormat::Bgrx32;
}

void rowToRgba(const Frame& frame, int row, std::uint8_t* to) {
  const int width = frame.format.width;
  const YuvCoefficients& c = coefficientsOf(frame.format);
  const std::uint8_t* in = frame.planes[0].data + row * frame.planes[0].stride;
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
    case PixelFormat::Bgrx32:
      bgrxToRgba(in, width, to);
      break;
    default:
      yuvRowToRgba(frame, row, c, to);
  }
  if (isRgb(frame.format.pixel_format) && frame.format.range == YuvRange::Limited)
    expandRgba(width, to);
}

/// Mean of up to 256 pixels R G B A, rounded. Two channels are summed in one word.
Rgb meanOfRun(const std::uint8_t* rgba, int pixels) {
  std::uint32_t red_blue = 0, green = 0;  // 16 bits a channel
  for (int i = 0; i < pixels; ++i) {
    std::uint32_t pixel;
    std::memcpy(&pixel, rgba + 4 * i, 4);
    red_blue += pixel & 0x00ff00ffu;
    green += pixel >> 8 & 0xffu;
  }
  const auto count = static_cast<std::uint32_t>(pixels);
  const auto mean = [&](std::uint32_t sum) {
    return static_cast<std::uint8_t>((sum + count / 2) / count);
  };
  return {mean(red_blue & 0xffffu), mean(green), mean(red_blue >> 16)};
}

}  // namespace

const YuvCoefficients& coefficientsOf(const FrameFormat& format) {
  return kCoefficients[static_cast<int>(format.matrix)][static_cast<int>(format.range)];
}

void toRgba(const Frame& frame, std::span<std::uint8_t> out) {
  if (!fits(frame, out, 4)) return;
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{4} * frame.format.width;
  for (int row = 0; row < frame.format.height; ++row)
    rowToRgba(frame, row, out.data() + row * row_bytes);
}

void toReducedRgb(const Frame& frame, std::span<Rgb> out) {
  const ColorReduction reduced(frame.format.width, frame.format.height);
  if (frame.empty() || frame.format.width > FramePool::kMaxSide_px || out.size() < reduced.pixels())
    return;
  std::uint8_t row[4 * FramePool::kMaxSide_px];
  Rgb* to = out.data();
  for (int y = 0; y < reduced.height; ++y) {
    rowToRgba(frame, y * reduced.factor + reduced.factor / 2, row);
    for (int x = 0; x < reduced.width; ++x, ++to)
      *to = meanOfRun(row + std::ptrdiff_t{4} * reduced.factor * x, reduced.factor);
  }
}

void toGray(const Frame& frame, std::span<std::uint8_t> out) {
  if (!fits(frame, out, 1)) return;
  const int width = frame.format.width;
  for (int row = 0; row < frame.format.height; ++row) {
    const std::uint8_t* in = frame.planes[0].data + row * frame.planes[0].stride;
    std::uint8_t* to = out.data() + std::ptrdiff_t{1} * row * width;
    switch (frame.format.pixel_format) {
      case PixelFormat::Rgb24:
        rgbToGray(in, width, 3, 0, 2, to);
        break;
      case PixelFormat::Bgr24:
        rgbToGray(in, width, 3, 2, 0, to);
        break;
      case PixelFormat::Rgba32:
        rgbToGray(in, width, 4, 0, 2, to);
        break;
      case PixelFormat::Bgrx32:
        rgbToGray(in, width, 4, 2, 0, to);
        break;
      case PixelFormat::Yuyv:
      case PixelFormat::Uyvy:
        lumaOf422(in, width, frame.format.pixel_format == PixelFormat::Uyvy, to);
        break;
      default:  // a Y plane
        std::memcpy(to, in, static_cast<std::size_t>(width));
    }
  }
}

}  // namespace depthscope::capture
