#pragma once
#include <cstdint>

/// What a row of pixels goes through on its way to R G B A or luma: small loops over integers,
/// which the compiler turns into vector code. Rows do not overlap; `pixels` says how many are
/// written.
namespace depthscope::capture {

inline constexpr int kFractionBits = 16;

/// `value` with kFractionBits fractional bits, rounded to nearest.
constexpr int fixedPoint(double value) {
  return static_cast<int>(value * (1 << kFractionBits) + (value < 0 ? -0.5 : 0.5));
}

struct YuvCoefficients {
  int y_offset = 0;
  int y = 0;  // kFractionBits fractional bits, as are all below
  int v_red = 0;
  int u_green = 0, v_green = 0;
  int u_blue = 0;
};

/// Each chroma sample twice: `samples` of them give 2 * samples values.
void duplicate(const std::uint8_t* __restrict chroma, int samples, std::uint8_t* __restrict out);
/// The same for interleaved U V U V.
void duplicateInterleaved(const std::uint8_t* __restrict uv, int samples,
                          std::uint8_t* __restrict u, std::uint8_t* __restrict v);
/// Y U Y V (`luma_at` 0) or U Y V Y (1) to one Y, U and V a pixel. An odd row's last pair is read
/// and written whole.
void unpack422(const std::uint8_t* __restrict packed, int pixels, int luma_at,
               std::uint8_t* __restrict y, std::uint8_t* __restrict u, std::uint8_t* __restrict v);

/// One U and one V for each Y.
void yuvToRgba(const std::uint8_t* __restrict y, const std::uint8_t* __restrict u,
               const std::uint8_t* __restrict v, int pixels, const YuvCoefficients& coefficient,
               std::uint8_t* __restrict out);
void grayToRgba(const std::uint8_t* __restrict y, int pixels, const YuvCoefficients& coefficient,
                std::uint8_t* __restrict out);
/// `red_at`, `blue_at`: 0 and 2 for R G B, 2 and 0 for B G R.
void rgb24ToRgba(const std::uint8_t* __restrict rgb, int pixels, int red_at, int blue_at,
                 std::uint8_t* __restrict out);
void rgba32ToRgba(const std::uint8_t* __restrict rgba, int pixels, std::uint8_t* __restrict out);
void bgrxToRgba(const std::uint8_t* __restrict bgrx, int pixels, std::uint8_t* __restrict out);
/// 16..235 to 0..255, in place.
void expandRgba(int pixels, std::uint8_t* rgba);

/// BT.601 luma of RGB, weights with kFractionBits fractional bits that add up to one.
void rgbToGray(const std::uint8_t* __restrict rgb, int pixels, int bytes_per_pixel, int red_at,
               int blue_at, std::uint8_t* __restrict out);
/// The Y of Y U Y V (`luma_at` 0) or U Y V Y (1).
void lumaOf422(const std::uint8_t* __restrict packed, int pixels, int luma_at,
               std::uint8_t* __restrict y);

}  // namespace depthscope::capture
