#pragma once
#include <memory>
#include <optional>
#include <span>

#include "overlay/overlay_settings.hpp"
#include "overlay/overlay_state.hpp"
#include "overlay/pixel_rect.hpp"
#include "types/camera_model.hpp"
#include "types/image_view.hpp"
#include "types/label.hpp"
#include "types/surface_mesh.hpp"
#include "types/view_outline.hpp"

namespace depthscope::overlay {

/// Draws picture and overlay with GLES 3 into an off-screen buffer (surfaceless EGL). Pixels that
/// the overlay does not touch are exactly the picture's. All calls from the thread that created it.
class Compositor {
 public:
  /// Throws InputError when EGL/GLES 3 or the font is not to be had; the message names which.
  Compositor(const CameraModel& camera, const OverlaySettings& settings);
  ~Compositor();
  Compositor(const Compositor&) = delete;
  Compositor& operator=(const Compositor&) = delete;

  /// The font and `max_labels` stay those of the constructor.
  void setSettings(const OverlaySettings& settings);
  /// Takes a copy of a new surface; it replaces the one before in a cross-fade. A surface is drawn
  /// only under poses of its own map; the one before stays in use for as long as poses are of its
  /// map instead. An empty mesh: none.
  void setSurface(const SurfaceMesh& mesh);
  /// The surface is drawn only where the scope shows anything. Until told, that is everywhere.
  void setView(const ViewOutline& view);
  /// Labels keep their place around the anchor by their `id`. The first `max_labels` are taken.
  void setLabels(std::span<const Label> labels);

  /// Composites one picture; it may have another size than the camera's (then the overlay, whose
  /// geometry no longer holds, is left out). `out`: picture.height * picture.width * 4 bytes, R G B
  /// A, top row first; it may be the picture's own memory. False: the graphics driver failed and
  /// `out` is the picture with a mark that says so, or the sizes do not fit and `out` is untouched.
  bool composite(const RgbaView& picture, const OverlayState& state, std::span<std::uint8_t> out);

  /// The overlay alone, for a hardware plane of its own, to lay over a picture later, or to know
  /// what it covers: premultiplied R G B A. Returns the rectangle outside of which composite()
  /// leaves the picture alone, where `out` is all zero; inside it composite() gives layer + (1 -
  /// alpha) picture. Nothing where composite() says false: `out` holds at most the status mark
  /// then.
  std::optional<PixelRect> drawLayer(int width, int height, const OverlayState& state,
                                     std::span<std::uint8_t> out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace depthscope::overlay
