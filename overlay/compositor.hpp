#pragma once
#include <memory>
#include <span>
#include <string_view>

#include "overlay/overlay_settings.hpp"
#include "types/camera_model.hpp"
#include "types/image_view.hpp"
#include "types/label.hpp"
#include "types/surface_mesh.hpp"
#include "types/tracking.hpp"

namespace depthscope::overlay {

/// What the status mark says.
enum class Status : std::uint8_t { NoAr, Initializing, Tracking, Lost, Stale, NoSignal };

/// Everything that decides how one picture is drawn over, besides surface and labels.
struct OverlayState {
  Status status = Status::NoAr;
  Pose T_camera_world;  // meaningful while status is Tracking
  std::uint32_t map_id =
      0;                 // map the pose belongs to; surface and labels of other maps are not drawn
  float confidence = 0;  // 0..1
  float age_ms = 0;  // picture's capture time minus the pose's frame's: fades towards max_age_ms
  std::string_view message;  // shown beside the mark, e.g. "no signal"; may be empty
  double time_s = -1;  // the picture's capture time, never falling: paces what eases from one state
                       // to the next. Negative: unknown, everything changes at once
};

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
  /// Labels keep their place around the anchor by their `id`. The first `max_labels` are taken.
  void setLabels(std::span<const Label> labels);

  /// Composites one picture; it may have another size than the camera's (then the overlay, whose
  /// geometry no longer holds, is left out). `out`: picture.height * picture.width * 4 bytes, R G B
  /// A, top row first; it may be the picture's own memory. False: the graphics driver failed and
  /// `out` is the picture alone, or the sizes do not fit and `out` is untouched.
  bool composite(const RgbaView& picture, const OverlayState& state, std::span<std::uint8_t> out);

  /// The overlay alone, for a hardware plane of its own or to know what it covers: premultiplied R
  /// G B A, transparent (all zero) where composite() leaves the picture alone. Elsewhere
  /// composite() gives layer + (1 - alpha) picture.
  bool drawLayer(int width, int height, const OverlayState& state, std::span<std::uint8_t> out);

  /// A full picture that says why there is none: dark, the message in its middle. False as in
  /// composite(), `out` being dark then.
  bool compositeFault(int width, int height, std::string_view message, std::span<std::uint8_t> out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace depthscope::overlay
