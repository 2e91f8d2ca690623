#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "types/camera_model.hpp"
#include "types/pose.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// A label that is asked for at a place of the picture.
struct LabelRequest {
  std::string text;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // in the picture as captured
};

/// Parses `TEXT@X,Y`. Throws InputError.
LabelRequest parseLabelRequest(std::string_view argument);

/// World point where the ray through `pixel` first meets the surface, or nothing.
std::optional<Eigen::Vector3f> anchorOnSurface(const SurfaceMesh& mesh, const CameraModel& camera,
                                               const Pose& T_camera_world,
                                               const Eigen::Vector2d& pixel);

}  // namespace depthscope::platform
