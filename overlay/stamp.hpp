#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "overlay/color.hpp"
#include "overlay/pixel_rect.hpp"
#include "overlay/text_rasterizer.hpp"

namespace depthscope::overlay {

/// A small picture, premultiplied R G B A, drawn once in memory with anti-aliased shapes and text
/// and then laid over many pictures. It needs no graphics driver, so it can still be shown when
/// that fails.
class Stamp {
 public:
  Stamp() = default;
  Stamp(int width, int height);

  /// A box with rounded corners; `stroke` 0: filled, else a line of that width inside its edge.
  void box(const Eigen::Vector2f& centre, const Eigen::Vector2f& half_size, float radius,
           float stroke, Color color);
  void disc(const Eigen::Vector2f& centre, float radius, Color color) {
    box(centre, {radius, radius}, radius, 0, color);
  }
  void ring(const Eigen::Vector2f& centre, float radius, float stroke, Color color) {
    box(centre, {radius, radius}, radius, stroke, color);
  }
  /// With round ends.
  void line(const Eigen::Vector2f& from, const Eigen::Vector2f& to, float width, Color color);
  void text(const Eigen::Vector2i& top_left, const TextBitmap& bitmap, Color color);

  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return width_ == 0; }

  /// Lays it with its top left corner at (x, y) over a picture (width * 4 bytes a row): as blendRow
  /// does, so that the picture's own alpha stays. What lies outside the picture is left out.
  void overPicture(int x, int y, std::span<std::uint8_t> picture, int width, int height) const;
  /// The same over a layer, premultiplied too, whose alpha grows by the stamp's. `layer` holds the
  /// pixels of `rect`.
  void overLayer(int x, int y, std::span<std::uint8_t> layer, const PixelRect& rect) const;

 private:
  /// A shape about `centre` whose local x axis is `axis`.
  void shade(const Eigen::Vector2f& centre, const Eigen::Vector2f& half_size,
             const Eigen::Vector2f& axis, float radius, float stroke, Color color);
  void put(int x, int y, float coverage, Color color);

  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> pixels_;
};

}  // namespace depthscope::overlay
