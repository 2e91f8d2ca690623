#pragma once
#include <filesystem>

#include "types/camera_model.hpp"

namespace depthscope::platform {

/// Reads a camera file (OpenCV YAML; keys image_width image_height [fps] camera_model fx fy cx cy
/// and k1 k2 p1 p2 [k3] for a pinhole, k1 k2 k3 k4 for a fisheye lens; pixels). Throws InputError
/// naming file and key: unreadable, missing key, not a finite number, unknown model, size or focal
/// length not positive.
CameraModel loadCameraFile(const std::filesystem::path& path);

/// Throws InputError naming the camera file unless it describes pictures of this size.
void requireSize(const CameraModel& camera, const std::filesystem::path& camera_file, int width,
                 int height);

}  // namespace depthscope::platform
