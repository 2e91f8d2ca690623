#pragma once
#include <cstdint>

namespace depthscope::overlay {

enum class CueMode : std::uint8_t {
  Off,             // the picture alone, every pixel as it came in (status mark only when something is wrong)
  Chromadepth,     // pseudo-chromadepth with contour lines: near bright and warm, far dark and cold
  Mesh,            // the paper's transparent mesh over the picture
};

/// Defaults in place; lengths in pixels of the picture unless said.
struct OverlaySettings {
  CueMode cue = CueMode::Chromadepth;
  float opacity = 0.45f;             // of the cue over the picture, 0..1
  bool inset = true;                 // the turned-aside view of the mesh in a corner
  bool labels = true;
  float max_age_ms = 120;            // an overlay older than this is gone; it fades before
  float label_height_px = 0;         // 0: from the picture's height
};

}  // namespace depthscope::overlay
