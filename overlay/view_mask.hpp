#pragma once
#include <array>

#include "overlay/gl_object.hpp"
#include "types/view_outline.hpp"

namespace depthscope::overlay {

/// A ViewOutline in the graphics card's memory, for shaders with view.glsl.
class ViewMask {
 public:
  ViewMask();
  void set(const ViewOutline& view);
  /// Makes it the texture of the given unit.
  void bind(GLuint unit) const;

 private:
  GlTexture ends_;
};

}  // namespace depthscope::overlay
