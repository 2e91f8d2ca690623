#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "slam/image_buffer.hpp"
#include "types/camera_model.hpp"

namespace depthscope::slam::testing {

/// Brightness of a made-up texture with detail at all scales, defined at every real position: the
/// same place can be looked at turned, scaled and shifted without resampling a picture.
class TissueTexture {
 public:
  explicit TissueTexture(std::uint32_t seed) : seed_(seed) {}

  /// [grey levels], mostly 40..200, with detail down to 4 px.
  double operator()(double x, double y) const {
    double sum = 0, amplitude = 14;
    for (double period = 96; period > 3; period /= 2, amplitude *= 1.25)
      sum += amplitude * noise(x / period, y / period, static_cast<std::uint32_t>(period));
    return 120 + sum;
  }

 private:
  double noise(double x, double y, std::uint32_t octave) const {
    const double fx = std::floor(x), fy = std::floor(y);
    const auto ix = static_cast<std::int32_t>(fx), iy = static_cast<std::int32_t>(fy);
    const auto smooth = [](double t) { return t * t * t * (t * (t * 6 - 15) + 10); };
    const double u = smooth(x - fx), v = smooth(y - fy);
    return (1 - v) * ((1 - u) * value(ix, iy, octave) + u * value(ix + 1, iy, octave)) +
           v * ((1 - u) * value(ix, iy + 1, octave) + u * value(ix + 1, iy + 1, octave));
  }
  double value(std::int32_t x, std::int32_t y, std::uint32_t octave) const {
    std::uint32_t h = seed_ ^ (octave * 0x9E3779B9U) ^
                      (static_cast<std::uint32_t>(x) * 0x85EBCA6BU) ^
                      (static_cast<std::uint32_t>(y) * 0xC2B2AE35U);
    h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
    h = (h ^ (h >> 12)) * 0x297A2D39U;
    h ^= h >> 15;
    return h / 2147483648.0 - 1;
  }

  std::uint32_t seed_;
};

/// A camera of small pictures.
inline CameraModel smallCamera() {
  CameraModel c;
  c.width = 320;
  c.height = 240;
  c.fx = c.fy = 300;
  c.cx = 159.5;
  c.cy = 119.5;
  return c;
}

/// A picture of width x height whose pixel (x, y) is brightness(x, y), rounded and clamped.
inline ImageBuffer draw(int width, int height,
                        const std::function<double(double, double)>& brightness) {
  ImageBuffer image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.row(y)[x] =
          static_cast<std::uint8_t>(std::clamp(std::lround(brightness(x, y)), 0L, 255L));
  return image;
}

}  // namespace depthscope::slam::testing
