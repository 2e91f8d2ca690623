#include "overlay/surface_pass.hpp"

#include <algorithm>
#include <cmath>

#include "overlay/lens.hpp"
#include "overlay/shader_text.hpp"

namespace depthscope::overlay {
namespace {

constexpr float kContoursInView = 14;
constexpr GLuint kViewUnit = 1;  // of the textures; 0 is for everybody

/// Uniforms of view.glsl that never change.
void setView(const ShaderProgram& program, const CameraModel& camera, const ViewMask& view) {
  program.use();
  glUniform1i(program.uniform("u_view"), kViewUnit);
  glUniform2f(program.uniform("u_view_scale"),
              ViewOutline::bands / static_cast<float>(camera.height), 1 / view.edge());
}

/// Uniforms of lens.glsl that never change.
void setLens(const ShaderProgram& program, const CameraModel& camera) {
  program.use();
  glUniform4f(program.uniform("u_intrinsics"), static_cast<float>(camera.fx),
              static_cast<float>(camera.fy), static_cast<float>(camera.cx),
              static_cast<float>(camera.cy));
  float k[5];
  for (std::size_t i = 0; i < camera.k.size(); ++i) k[i] = static_cast<float>(camera.k[i]);
  glUniform1fv(program.uniform("u_k"), 5, k);
  glUniform1i(program.uniform("u_fisheye"), camera.kind == CameraModel::Kind::Fisheye);
  glUniform1f(program.uniform("u_max_radius"), static_cast<float>(validRadius(camera)));
  glUniform2f(program.uniform("u_picture"), static_cast<float>(camera.width),
              static_cast<float>(camera.height));
}

}  // namespace

SurfacePass::Cue::Cue(const CameraModel& camera, const ViewMask& view, const char* define)
    : program("surface", {define, shader_text::lens, shader_text::surface_vert},
              {define, shader_text::ramp, shader_text::view, shader_text::surface_frag}),
      R(program.uniform("u_R_camera_surface")),
      t(program.uniform("u_t_camera_surface")),
      clip_depths(program.uniform("u_clip_depths")),
      depth_scale(program.uniform("u_depth_scale")),
      contour(program.uniform("u_contour")),
      opacity(program.uniform("u_opacity")),
      alpha(program.uniform("u_alpha")) {
  setLens(program, camera);
  setView(program, camera, view);
}

SurfacePass::SurfacePass(const CameraModel& camera, const ViewMask& view)
    : view_(view), chromadepth_(camera, view, ""), mesh_(camera, view, "#define CUE_MESH\n") {}

void SurfacePass::setUp(const Cue& cue, const Pose& T_camera_surface, const CueStyle& style,
                        float alpha) const {
  const Eigen::Matrix3f R = T_camera_surface.R.cast<float>();
  const Eigen::Vector3f t = T_camera_surface.t.cast<float>();
  const std::array<float, 2> clip = clipDepths(style.near_depth, style.far_depth);
  const float span = style.far_depth - style.near_depth;
  // Lines lie at multiples of a power of two. Between one power and the next every second line
  // fades, so that the spacing never jumps.
  const float octave = std::log2(span / kContoursInView);
  const float floor_octave = std::floor(octave);

  view_.bind(kViewUnit);
  cue.program.use();
  glUniformMatrix3fv(cue.R, 1, GL_FALSE, R.data());
  glUniform3fv(cue.t, 1, t.data());
  glUniform2f(cue.clip_depths, clip[0], clip[1]);
  glUniform2f(cue.depth_scale, style.near_depth, style.near_depth * style.far_depth / span);
  glUniform2f(cue.contour, std::exp2(-floor_octave), 1 - (octave - floor_octave));
  glUniform1f(cue.opacity, style.opacity);
  glUniform1f(cue.alpha, alpha);
}

void SurfacePass::draw(const SurfaceBuffers& surface, const Pose& T_camera_surface,
                       const CueStyle& style, float alpha) const {
  setUp(cueOf(style), T_camera_surface, style, alpha);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  surface.draw();
}

void SurfacePass::drawAdded(const SurfaceBuffers& surface, const Pose& T_camera_surface,
                            const CueStyle& style, float alpha) const {
  setUp(cueOf(style), T_camera_surface, style, alpha);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  surface.draw();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthFunc(GL_EQUAL);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  surface.draw();
  glDisable(GL_BLEND);
}

}  // namespace depthscope::overlay
