#pragma once
#include <filesystem>

#include "types/camera_model.hpp"

namespace depthscope::platform {

/// Writes a camera file (OpenCV YAML) that `loadCameraFile` reads back to the same numbers; `fps`
/// only where it is known. Atomic: the old file stays until the new one is whole. Throws InputError
/// when it cannot be written.
void saveCameraFile(const std::filesystem::path& path, const CameraModel& camera);

}  // namespace depthscope::platform
