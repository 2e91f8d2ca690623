#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "overlay/color.hpp"
#include "overlay/gl_object.hpp"
#include "overlay/layer.hpp"
#include "overlay/shader_program.hpp"
#include "overlay/text_atlas.hpp"

namespace depthscope::overlay {

/// A place on the tissue that a shape belongs to, and what becomes of the shape when tissue in
/// front hides it.
struct Anchor {
  enum class WhenHidden : std::uint8_t { Same, Dimmed, Gone, OnlyThen };
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  float depth = 0;  // 0: cannot be hidden
  WhenHidden when_hidden = WhenHidden::Same;

  Anchor but(WhenHidden other) const { return {pixel, depth, other}; }
};

/// Anti-aliased flat shapes and text in pixels of the picture, collected and then drawn together in
/// their order.
class Ink {
 public:
  static constexpr std::size_t kCapacity = 1024;  // shapes; more are dropped

  Ink();
  void clear() { shapes_.clear(); }
  bool empty() const { return shapes_.empty(); }

  /// A box with rounded corners; `stroke` 0: filled, else a line of that width inside its edge.
  void box(const Eigen::Vector2f& centre, const Eigen::Vector2f& half_size, float radius,
           float stroke, Color color, const Anchor& anchor = {});
  void disc(const Eigen::Vector2f& centre, float radius, Color color, const Anchor& anchor = {}) {
    box(centre, {radius, radius}, radius, 0, color, anchor);
  }
  void ring(const Eigen::Vector2f& centre, float radius, float stroke, Color color,
            const Anchor& anchor = {}) {
    box(centre, {radius, radius}, radius, stroke, color, anchor);
  }
  /// With round ends. `dash_px`: period of the dashes it is drawn in while its anchor is hidden; 0:
  /// never dashed.
  void line(const Eigen::Vector2f& from, const Eigen::Vector2f& to, float width, Color color,
            const Anchor& anchor = {}, float dash_px = 0);
  /// `top_left` is rounded to whole pixels, to keep the glyphs crisp.
  void text(const Eigen::Vector2f& top_left, const TextSpot& spot, Color color,
            const Anchor& anchor = {});

  /// Draws and keeps the shapes. `depth_texture` 0: no anchor counts as hidden. `clip_depths`:
  /// planes the depths were drawn with.
  void draw(const Layer& layer, GLuint text_texture, GLuint depth_texture,
            std::array<float, 2> clip_depths, float alpha);

 private:
  struct Shape {
    float box[4], shape[4], color[4], anchor[4], extra[4];
  };
  void add(const Eigen::Vector2f& centre, const Eigen::Vector2f& half_size,
           const Eigen::Vector2f& axis, float radius, float stroke, Color color,
           const Anchor& anchor, const Eigen::Vector4f& extra);

  ShaderProgram program_;
  GLint picture_, clip_depths_, alpha_;
  GlVertexArray array_;
  GlBuffer buffer_;
  GlTexture far_depth_;  // stands in where there is no surface: nothing is hidden
  std::vector<Shape> shapes_;
};

}  // namespace depthscope::overlay
