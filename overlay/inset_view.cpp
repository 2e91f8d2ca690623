#include "overlay/inset_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "overlay/lens.hpp"
#include "overlay/shader_text.hpp"

namespace depthscope::overlay {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3d;

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr double kNewReference = 45 * kRadPerDeg;  // the scope looks from elsewhere
constexpr double kEasing_s = 0.7;                  // time constant of the frame
constexpr double kFill = 0.86;                     // of the panel
constexpr float kMinFade = 0.15f;                  // as in the shader
constexpr Color kPanel{0.035f, 0.045f, 0.06f, 0.80f};
constexpr Color kFrame{0.80f, 0.86f, 0.92f, 0.40f};
constexpr Color kScope{0.86f, 0.93f, 1.0f, 0.9f};
constexpr Color kAnchor{1.0f, 1.0f, 1.0f, 1.0f};

}  // namespace

InsetView::InsetView(const CameraModel& camera, const OverlaySettings& settings)
    : camera_(camera),
      program_("inset", {shader_text::inset_vert}, {shader_text::ramp, shader_text::inset_frag}),
      R_camera_(program_.uniform("u_R_camera_surface")),
      t_camera_(program_.uniform("u_t_camera_surface")),
      R_view_(program_.uniform("u_R_view_surface")),
      t_view_(program_.uniform("u_t_view_surface")),
      view_scale_(program_.uniform("u_view_scale")),
      depth_scale_(program_.uniform("u_depth_scale")),
      alpha_(program_.uniform("u_alpha")) {
  const double right = camera.width - 1, bottom = camera.height - 1;
  const Eigen::Vector2d corners[4] = {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}};
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector2d n = camera.unproject(corners[i]);
    n *= std::min(1.0, std::min(validRadius(camera), 2.0) / std::max(n.norm(), 1e-9));
    corner_rays_[i] = {n.x(), n.y(), 1};
  }
  setSettings(settings);
}

void InsetView::setSettings(const OverlaySettings& settings) {
  turn_rad_ = settings.inset_turn_deg * kRadPerDeg;
  const int w =
      static_cast<int>(std::lround(settings.inset_width * static_cast<float>(camera_.width)));
  const int h = w * 3 / 4, margin = camera_.height / 48;
  panel_ = {camera_.width - margin - w, margin, camera_.width - margin, margin + h};
  framed_ = false;
}

/// Bounding box, in the view frame, of all that is to be seen.
Eigen::AlignedBox3d InsetView::contents(const PreparedSurface& surface) const {
  const Eigen::Matrix3d R = q_view_surface_.toRotationMatrix();
  const Eigen::Matrix3f Rf = R.cast<float>();
  Eigen::AlignedBox3f mesh;
  for (const InsetVertex& v : surface.inset_vertices)
    if (v.fade > kMinFade * 255)
      mesh.extend(Rf * Eigen::Vector3f(v.position[0], v.position[1], v.position[2]));
  Eigen::AlignedBox3d all(mesh.min().cast<double>(), mesh.max().cast<double>());
  const Pose T_surface_camera = T_camera_surface_.inverse();
  all.extend(R * T_surface_camera.t);
  for (const Vector3d& ray : corner_rays_) all.extend(R * (T_surface_camera * (ray * ray_depth_)));
  return all;
}

void InsetView::frame(const PreparedSurface& surface, const Pose& T_camera_surface,
                      float near_depth, double dt_s) {
  T_camera_surface_ = T_camera_surface;
  ray_depth_ = 0.8 * near_depth;
  const Eigen::Quaterniond now = T_camera_surface.quaternion();
  if (!framed_ || now.angularDistance(reference_) > kNewReference) reference_ = now;
  const Eigen::Quaterniond wanted(Eigen::AngleAxisd(turn_rad_, Vector3d::UnitY()) * reference_);
  const double k = framed_ && dt_s >= 0 ? 1 - std::exp(-dt_s / kEasing_s) : 1.0;
  q_view_surface_ = framed_ ? q_view_surface_.slerp(k, wanted) : wanted;

  const Eigen::AlignedBox3d box = contents(surface);
  const Vector3d size = box.sizes().cwiseMax(1e-6);
  const double scale = kFill * std::min(panel_.width() / size.x(), panel_.height() / size.y());
  const double blend = framed_ ? k : 1.0;
  centre_ += blend * (box.center() - centre_);
  px_per_unit_ *= std::pow(scale / px_per_unit_, blend);
  half_depth_ = size.norm();  // generous: the centre may lag behind
  framed_ = true;
}

Vector2f InsetView::toPixel(const Vector3d& p_surface) const {
  const Vector3d p = px_per_unit_ * (q_view_surface_ * p_surface - centre_);
  return {static_cast<float>(0.5 * (panel_.x0 + panel_.x1 - 1) + p.x()),
          static_cast<float>(0.5 * (panel_.y0 + panel_.y1 - 1) + p.y())};
}

void InsetView::drawPanel(Ink& ink) const {
  const Vector2f half(0.5f * static_cast<float>(panel_.width()),
                      0.5f * static_cast<float>(panel_.height()));
  const Vector2f centre = Vector2f(static_cast<float>(panel_.x0), static_cast<float>(panel_.y0)) +
                          half - Vector2f(0.5f, 0.5f);
  const float radius = 0.03f * static_cast<float>(panel_.width());
  ink.box(centre, half, radius, 0, kPanel);
  ink.box(centre, half, radius, 1.2f, kFrame);
}

void InsetView::drawMesh(const SurfaceBuffers& surface, const CueStyle& style, float alpha) const {
  const Eigen::Matrix3f R_camera = T_camera_surface_.R.cast<float>();
  const Eigen::Vector3f t_camera = T_camera_surface_.t.cast<float>();
  const Eigen::Matrix3f R_view = q_view_surface_.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t_view = -centre_.cast<float>();
  program_.use();
  glUniformMatrix3fv(R_camera_, 1, GL_FALSE, R_camera.data());
  glUniform3fv(t_camera_, 1, t_camera.data());
  glUniformMatrix3fv(R_view_, 1, GL_FALSE, R_view.data());
  glUniform3fv(t_view_, 1, t_view.data());
  glUniform3f(view_scale_, static_cast<float>(2 * px_per_unit_ / panel_.width()),
              static_cast<float>(2 * px_per_unit_ / panel_.height()),
              static_cast<float>(1 / half_depth_));
  glUniform2f(depth_scale_, style.near_depth,
              style.near_depth * style.far_depth / (style.far_depth - style.near_depth));
  glUniform1f(alpha_, alpha);
  glViewport(panel_.x0, panel_.y0, panel_.width(), panel_.height());
  glScissor(panel_.x0 + 2, panel_.y0 + 2, panel_.width() - 4, panel_.height() - 4);
  glEnable(GL_SCISSOR_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  surface.drawInset();
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
}

void InsetView::drawMarks(std::span<const Label> labels, const PreparedSurface& surface,
                          Ink& ink) const {
  const float unit = std::max(1.0f, static_cast<float>(camera_.height) / 480.0f);
  const Pose T_surface_camera = T_camera_surface_.inverse();
  const Vector2f eye = toPixel(T_surface_camera.t);
  Vector2f corners[4];
  for (int i = 0; i < 4; ++i)
    corners[i] = toPixel(T_surface_camera * (corner_rays_[i] * ray_depth_));
  for (int i = 0; i < 4; ++i) {
    ink.line(eye, corners[i], 1.0f * unit, kScope.withAlpha(0.55f));
    ink.line(corners[i], corners[(i + 1) % 4], 1.2f * unit, kScope.withAlpha(0.75f));
  }
  ink.disc(eye, 2.6f * unit, kScope);
  const Eigen::AlignedBox2f inside(
      Vector2f(static_cast<float>(panel_.x0 + 4), static_cast<float>(panel_.y0 + 4)),
      Vector2f(static_cast<float>(panel_.x1 - 5), static_cast<float>(panel_.y1 - 5)));
  for (const Label& label : labels) {
    if (label.map_id != surface.map_id || !label.anchor.allFinite()) continue;
    const Vector2f px = toPixel(label.anchor.cast<double>() - surface.origin);
    if (!inside.contains(px)) continue;
    ink.disc(px, 3.2f * unit, {0.03f, 0.03f, 0.05f, 0.8f});
    ink.disc(px, 2.1f * unit, kAnchor);
  }
}

}  // namespace depthscope::overlay
