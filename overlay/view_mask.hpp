#pragma once
#include <array>

#include "overlay/gl_object.hpp"
#include "types/view_outline.hpp"

namespace depthscope::overlay {

/// A ViewOutline in the graphics card's memory, for shaders with view.glsl.
class ViewMask {
 public:
  /// For pictures of this size [px].
  ViewMask(int width, int height);
  void set(const ViewOutline& view);
  /// Width of the soft edge [px].
  float edge() const { return edge_; }
  /// Makes it the texture of the given unit.
  void bind(GLuint unit) const;

 private:
  float width_, edge_;
  GlTexture ends_;
};

}  // namespace depthscope::overlay
