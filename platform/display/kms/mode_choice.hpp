#pragma once
#include <drm_mode.h>

#include <optional>
#include <span>

#include "platform/display/mode_request.hpp"

namespace depthscope::platform::kms {

/// The picture that a mode is to fit.
struct PictureRate {
  int width = 0, height = 0;  // [px]
  double fps = 0;             // 0: unknown
};

/// Vertical refresh [Hz] from the mode's pixel clock.
double refreshRate(const drm_mode_modeinfo& mode);

/// Which of a monitor's modes to show the picture in, so that its pixels stay what they are:
/// 1. the picture's size at the picture's rate, or at the smallest whole multiple of it;
/// 2. the picture's size at the highest rate;
/// 3. the monitor's preferred mode, where the picture has room in it (it is centred, black around);
/// 4. the smallest mode that has room;
/// 5. the largest one (the picture has to be scaled down).
/// Interlaced, double-scanned and stereo modes are left out. A mode that is asked for comes before
/// all this, if the monitor has it. Empty: no mode that can be used.
std::optional<std::size_t> chooseMode(std::span<const drm_mode_modeinfo> modes,
                                      const PictureRate& picture, const ModeRequest& request);

}  // namespace depthscope::platform::kms
