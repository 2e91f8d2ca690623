#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
  Pose T_camera_world;               // meaningful while status is Tracking
  std::uint32_t map_id = 0;          // map the pose belongs to; surface and labels of other maps are not drawn
  float confidence = 0;              // 0..1
  float age_ms = 0;                  // picture's capture time minus the pose's frame's: fades towards max_age_ms
  std::string_view message;          // shown beside the mark, e.g. "no signal"; may be empty
};

/// Draws picture and overlay with GLES 3 into an off-screen buffer (surfaceless EGL). Pixels that the
/// overlay does not touch are exactly the picture's. All calls from the thread that created it.
class Compositor {
 public:
  /// Throws InputError when EGL/GLES 3 or the font is not to be had; the message names which.
  Compositor(const CameraModel& camera, const OverlaySettings& settings);
  ~Compositor();
  Compositor(const Compositor&) = delete;
  Compositor& operator=(const Compositor&) = delete;

  void setSettings(const OverlaySettings& settings);
  /// Uploads a new surface; it replaces the old one.
  void setSurface(const SurfaceMesh& mesh);
  void setLabels(std::span<const Label> labels);

  /// Composites one picture; it may have another size than the camera's (then the overlay, whose
  /// geometry no longer holds, is left out). `out`: picture.height * picture.width * 4 bytes, R G B A, top row first.
  void composite(const RgbaView& picture, const OverlayState& state, std::span<std::uint8_t> out);

  /// A full picture that says why there is none: dark, the message in its middle.
  void compositeFault(int width, int height, std::string_view message, std::span<std::uint8_t> out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace depthscope::overlay
