#include "overlay/stamp.hpp"

#include <algorithm>
#include <cmath>

#include "overlay/blend.hpp"

namespace depthscope::overlay {
namespace {

using Eigen::Vector2f;

std::size_t offset(int x, int y, int width) {
  return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
              static_cast<std::size_t>(x));
}

std::uint8_t toByte(float share) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
}

}  // namespace

Stamp::Stamp(int width, int height)
    : width_(std::max(width, 0)),
      height_(std::max(height, 0)),
      pixels_(offset(0, height_, width_)) {}

void Stamp::put(int x, int y, float coverage, Color color) {
  if (coverage <= 0) return;
  std::uint8_t* p = pixels_.data() + offset(x, y, width_);
  const float alpha = coverage * color.a, keep = 1 - alpha;
  const float rgba[4] = {color.r * alpha, color.g * alpha, color.b * alpha, alpha};
  for (int c = 0; c < 4; ++c) p[c] = toByte(rgba[c] + keep * static_cast<float>(p[c]) / 255);
}

/// Coverage by the distance to the shape's edge, half a pixel of ramp on either side.
void Stamp::shade(const Vector2f& centre, const Vector2f& half_size, const Vector2f& axis,
                  float radius, float stroke, Color color) {
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Vector2f d =
          Vector2f(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) - centre;
      const Vector2f local(d.dot(axis), d.x() * -axis.y() + d.y() * axis.x());
      const Vector2f q = local.cwiseAbs() - half_size + Vector2f::Constant(radius);
      float distance = q.cwiseMax(0.0f).norm() + std::min(std::max(q.x(), q.y()), 0.0f) - radius;
      if (stroke > 0) distance = std::abs(distance + 0.5f * stroke) - 0.5f * stroke;
      put(x, y, std::clamp(0.5f - distance, 0.0f, 1.0f), color);
    }
}

void Stamp::box(const Vector2f& centre, const Vector2f& half_size, float radius, float stroke,
                Color color) {
  shade(centre, half_size, {1, 0}, radius, stroke, color);
}

void Stamp::line(const Vector2f& from, const Vector2f& to, float width, Color color) {
  const Vector2f along = to - from;
  const float length = along.norm();
  const Vector2f axis = length > 0 ? Vector2f(along / length) : Vector2f(1, 0);
  shade(0.5f * (from + to), {0.5f * (length + width), 0.5f * width}, axis, 0.5f * width, 0, color);
}

void Stamp::text(const Eigen::Vector2i& top_left, const TextBitmap& bitmap, Color color) {
  const Color surround{0, 0, 0, 0.75f * color.a};
  for (int y = 0; y < bitmap.height; ++y)
    for (int x = 0; x < bitmap.width; ++x) {
      const int px = top_left.x() + x, py = top_left.y() + y;
      if (px < 0 || py < 0 || px >= width_ || py >= height_) continue;
      const std::uint8_t* g = bitmap.pixels.data() + offset(x, y, bitmap.width) / 2;
      put(px, py, static_cast<float>(g[1]) / 255, surround);
      put(px, py, static_cast<float>(g[0]) / 255, color);
    }
}

void Stamp::overPicture(int x, int y, std::span<std::uint8_t> picture, int width,
                        int height) const {
  const PixelRect r = PixelRect{x, y, x + width_, y + height_}.clipped({0, 0, width, height});
  if (r.empty()) return;
  for (int row = r.y0; row < r.y1; ++row) {
    std::uint8_t* to = picture.data() + offset(r.x0, row, width);
    blendRow(pixels_.data() + offset(r.x0 - x, row - y, width_), to, to, r.width());
  }
}

void Stamp::overLayer(int x, int y, std::span<std::uint8_t> layer, const PixelRect& rect) const {
  const PixelRect r = PixelRect{x, y, x + width_, y + height_}.clipped(rect);
  for (int row = r.y0; row < r.y1; ++row)
    for (int column = r.x0; column < r.x1; ++column) {
      const std::uint8_t* from = pixels_.data() + offset(column - x, row - y, width_);
      std::uint8_t* to = layer.data() + offset(column - rect.x0, row - rect.y0, rect.width());
      blendLayerPixel(from, to);
    }
}

}  // namespace depthscope::overlay
