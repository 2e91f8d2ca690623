#pragma once
#include <cstdint>
#include <string>

namespace depthscope::overlay {

enum class CueMode : std::uint8_t {
  Off,  // the picture alone, every pixel as it came in (status mark only when something is wrong)
  Chromadepth,  // pseudo-chromadepth with contour lines: near bright and warm, far dark and cold
  Mesh,         // the paper's transparent mesh over the picture
};

/// Defaults in place; lengths in pixels of the picture unless said. "Of the mesh" is a share of the
/// diagonal of its bounding box, for a monocular map has no unit of length.
struct OverlaySettings {
  CueMode cue = CueMode::Chromadepth;
  float opacity = 0.45f;      // of the cue over the picture, 0..1
  bool inset = true;          // the turned-aside view of the mesh in a corner
  bool labels = true;         // text anchored to the tissue
  float max_age_ms = 120;     // an overlay older than this is gone; it fades from half of it
  float label_height_px = 0;  // of the text; 0: from the picture's height
  std::string font_file;      // TrueType file; empty: DejaVu Sans where Debian puts it

  float gone_confidence = 0.1f;  // of the pose, at or below which nothing is drawn over the picture
  float full_confidence = 0.3f;  // of the pose, from which the overlay has its whole strength
  float crossfade_s = 0.4f;      // from one surface to the next
  float border_fade = 0.03f;     // width of the surface's soft border, of the mesh
  float inset_turn_deg = 50;     // of the turned-aside view, about the picture's vertical axis
  float inset_width = 0.25f;     // of the picture's width
  int max_triangles = 30000;     // drawn of a surface; one of more is made coarser before
  int max_labels = 32;           // memory is set aside for so many; later ones are left out
};

}  // namespace depthscope::overlay
