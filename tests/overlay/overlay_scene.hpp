#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "overlay/compositor.hpp"
#include "tests/types/grid_mesh.hpp"

namespace depthscope::overlay {

inline CameraModel testCamera() {
  CameraModel c;
  c.width = 320;
  c.height = 240;
  c.fx = c.fy = 260;
  c.cx = 159.5;
  c.cy = 119.5;
  return c;
}

/// Settings without what eases, fades or decorates, so that pixels have known values.
inline OverlaySettings plainSettings() {
  OverlaySettings s;
  s.inset = false;
  s.labels = false;
  s.border_fade = 0;
  s.crossfade_s = 0;
  return s;
}

/// A grid of n x n squares over [x0, x1] x [y0, y1] whose depth runs from `z_left` to `z_right`,
/// world = camera frame.
inline SurfaceMesh wall(float x0, float x1, float y0, float y1, float z_left, float z_right,
                        int n = 16) {
  return gridMesh(static_cast<std::uint32_t>(n), [&](float u, float v) {
    return Eigen::Vector3f(x0 + u * (x1 - x0), y0 + v * (y1 - y0), z_left + u * (z_right - z_left));
  });
}

inline OverlayState tracking() {
  OverlayState s;
  s.status = Status::Tracking;
  s.confidence = 1;
  return s;
}

/// Rows of RGBA bytes, top first.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;

  Image(int w, int h, std::uint8_t value = 0)
      : width(w),
        height(h),
        bytes(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 4, value) {}
  const std::uint8_t* at(int x, int y) const {
    return bytes.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x)) *
                              4;
  }
  RgbaView view() const { return {bytes.data(), width, height, 4 * width}; }
  double luminance(int x, int y) const {
    return 0.2126 * at(x, y)[0] + 0.7152 * at(x, y)[1] + 0.0722 * at(x, y)[2];
  }
  /// Pixels in which anything was drawn, within a rectangle.
  int covered(int x0, int y0, int x1, int y1) const {
    int n = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) n += at(x, y)[3] > 0;
    return n;
  }
};

inline Image noise(int w, int h) {
  Image image(w, h);
  std::mt19937 random(7);
  for (std::uint8_t& b : image.bytes) b = static_cast<std::uint8_t>(random());
  return image;
}

inline Image layerOf(Compositor& compositor, const OverlayState& state, int w = 320, int h = 240) {
  Image image(w, h, 99);
  if (!compositor.drawLayer(w, h, state, image.bytes)) image.bytes.assign(image.bytes.size(), 99);
  return image;
}

inline Image compositeOf(Compositor& compositor, const Image& picture, const OverlayState& state) {
  Image image(picture.width, picture.height, 99);
  compositor.composite(picture.view(), state, image.bytes);
  return image;
}

// The status mark lies above this row.
constexpr int kBelowMark = 32;

}  // namespace depthscope::overlay
