#pragma once
#include <array>

#include "overlay/gl_object.hpp"
#include "overlay/overlay_settings.hpp"
#include "overlay/shader_program.hpp"
#include "overlay/surface_prep.hpp"
#include "overlay/vertex_buffer.hpp"
#include "overlay/view_mask.hpp"
#include "types/camera_model.hpp"
#include "types/pose.hpp"

namespace depthscope::overlay {

/// A prepared surface in the graphics card's memory.
class SurfaceBuffers {
 public:
  SurfaceBuffers();
  void upload(const PreparedSurface& surface);
  void draw() const;
  void drawInset() const;

 private:
  GlVertexArray array_, inset_array_;
  VertexBuffer vertices_, indices_, inset_vertices_, inset_indices_;
  GLsizei count_ = 0, inset_count_ = 0;
};

/// What the surface's depths are measured against and how strongly the cue is drawn.
struct CueStyle {
  CueMode mode = CueMode::Chromadepth;
  float opacity = 0;
  float near_depth = 0, far_depth = 1;  // ends of the colour ramp
};

/// Depths of the clipping planes for a scene between the two: generous, for they only guard the
/// projection.
inline std::array<float, 2> clipDepths(float near_depth, float far_depth) {
  return {0.05f * near_depth, 20.0f * far_depth};
}

/// Draws a surface over the picture, bent as the lens bends it, in the style of the cue.
class SurfacePass {
 public:
  /// Draws within `view`, which outlives it.
  SurfacePass(const CameraModel& camera, const ViewMask& view);

  /// Into the bound framebuffer; replaces what is behind, `alpha` fades all of it.
  void draw(const SurfaceBuffers& surface, const Pose& T_camera_surface, const CueStyle& style,
            float alpha) const;
  /// Adds a surface to what is drawn already, for a cross-fade: the depth buffer is cleared first.
  void drawAdded(const SurfaceBuffers& surface, const Pose& T_camera_surface, const CueStyle& style,
                 float alpha) const;

 private:
  struct Cue {
    Cue(const CameraModel& camera, const ViewMask& view, const char* define);
    ShaderProgram program;
    GLint R, t, clip_depths, depth_scale, contour, opacity, alpha;
  };
  void setUp(const Cue& cue, const Pose& T_camera_surface, const CueStyle& style,
             float alpha) const;
  const Cue& cueOf(const CueStyle& style) const {
    return style.mode == CueMode::Mesh ? mesh_ : chromadepth_;
  }

  const ViewMask& view_;
  Cue chromadepth_, mesh_;
};

}  // namespace depthscope::overlay
