#pragma once
#include <Eigen/Geometry>
#include <span>

#include "overlay/ink.hpp"
#include "overlay/surface_pass.hpp"
#include "types/label.hpp"

namespace depthscope::overlay {

/// The turned-aside view (Chen et al. 2017, figure 6 d): the mesh seen from the side in a corner of
/// the picture, with the scope, what it sees, and the labels' anchors, so that depths can be
/// inspected. Orthographic.
class InsetView {
 public:
  InsetView(const CameraModel& camera, const OverlaySettings& settings);
  void setSettings(const OverlaySettings& settings);

  /// What the panel covers.
  PixelRect panel() const { return panel_; }
  void forget() { framed_ = false; }

  /// Chooses direction and frame for this picture. The direction stays with the tissue, not with
  /// the scope (else nothing would show how the scope moves), until the scope looks from elsewhere.
  /// `dt_s` < 0: unknown, nothing is eased.
  void frame(const PreparedSurface& surface, const Pose& T_camera_surface, float near_depth,
             double dt_s);
  void drawPanel(Ink& ink) const;
  /// The mesh, into the bound framebuffer with its depth buffer.
  void drawMesh(const SurfaceBuffers& surface, const CueStyle& style, float alpha) const;
  /// The scope with its field of view, and the anchors of labels of the surface's map.
  void drawMarks(std::span<const Label> labels, const PreparedSurface& surface, Ink& ink) const;

 private:
  Eigen::Vector2f toPixel(const Eigen::Vector3d& p_surface) const;
  Eigen::AlignedBox3d contents(const PreparedSurface& surface) const;

  CameraModel camera_;
  std::array<Eigen::Vector3d, 4> corner_rays_;  // of the picture, camera frame, z = 1
  double turn_rad_ = 0;
  PixelRect panel_;
  ShaderProgram program_;
  GLint R_camera_, t_camera_, R_view_, t_view_, view_scale_, depth_scale_, alpha_;

  bool framed_ = false;
  Pose T_camera_surface_;
  double ray_depth_ = 1;          // how far the field of view is drawn
  Eigen::Quaterniond reference_;  // the scope's orientation the view is turned from
  Eigen::Quaterniond q_view_surface_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();  // of what is shown, view frame
  double px_per_unit_ = 1, half_depth_ = 1;
};

}  // namespace depthscope::overlay
