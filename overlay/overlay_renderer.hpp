#pragma once
#include <optional>
#include <span>

#include "overlay/compositor.hpp"
#include "overlay/depth_range.hpp"
#include "overlay/egl_context.hpp"
#include "overlay/ink.hpp"
#include "overlay/inset_view.hpp"
#include "overlay/label_pass.hpp"
#include "overlay/layer.hpp"
#include "overlay/surface_stack.hpp"
#include "overlay/text_atlas.hpp"
#include "overlay/view_mask.hpp"

namespace depthscope::overlay {

/// Draws what hangs on a pose (cues, labels, turned-aside view) into one transparent layer.
class OverlayRenderer {
 public:
  OverlayRenderer(const CameraModel& camera, const OverlaySettings& settings);

  void setSettings(const OverlaySettings& settings);
  void setSurface(const SurfaceMesh& mesh);
  void setView(const ViewOutline& view);
  void setLabels(std::span<const Label> labels);

  /// Draws the layer for a picture of this size; nothing if the driver fails. Returns the rectangle
  /// outside of which the layer is transparent and was not touched; empty when there is nothing to
  /// draw. `mark`: place of the status mark, which labels keep clear of.
  std::optional<PixelRect> draw(int width, int height, const OverlayState& state,
                                const PixelRect& mark);
  /// Pixels of the layer just drawn, as Layer::read.
  bool read(const PixelRect& rect, std::uint8_t* rgba);

 private:
  void warmUp();
  bool prepare(int width, int height);
  void drawTissueCues(const OverlayState& state, double dt_s, float alpha, const PixelRect& mark);
  void drawCue(const SurfaceStack::Shown& shown, const CueStyle& style, const Pose& T_camera_world,
               float alpha);
  void addLabels(const OverlayState& state, const PixelRect& mark, bool inset);
  double advance(double time_s);
  float ease(const OverlayState& state, double dt_s) const;

  CameraModel camera_;
  OverlaySettings settings_;
  const int max_labels_;
  EglContext context_;  // before all that lives in it
  TextRasterizer rasterizer_;
  Layer layer_;
  ViewMask view_;
  SurfacePass surface_pass_;
  SurfaceStack surfaces_;
  DepthRange range_;
  std::uint32_t range_map_ = 0;
  InsetView inset_;
  LabelPass labels_;
  Ink ink_;
  std::optional<TextAtlas> atlas_;  // made for the picture's size
  double last_time_s_ = -1;
  float alpha_ = 0;  // of the picture before
};

}  // namespace depthscope::overlay
