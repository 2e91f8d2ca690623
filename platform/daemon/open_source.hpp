#pragma once
#include <memory>

#include "capture/frame_source.hpp"
#include "platform/config/settings.hpp"
#include "types/camera_model.hpp"

namespace depthscope::platform {

/// Throws InputError, naming the key, unless there is one source of pictures and what is said of a
/// card makes sense.
void checkCapture(const CaptureSettings& settings);

/// What the source is asked of a card, the camera file's size where none is set.
capture::V4l2Settings cardSettings(const CaptureSettings& settings, const CameraModel& camera);

/// Opens the capture card, which may be missing for now, or the clip. Throws InputError.
std::unique_ptr<capture::FrameSource> openSource(const CaptureSettings& settings,
                                                 const CameraModel& camera);

}  // namespace depthscope::platform
