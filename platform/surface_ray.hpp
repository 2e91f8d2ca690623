#pragma once
#include <Eigen/Core>
#include <optional>

#include "types/camera_model.hpp"
#include "types/pose.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// A line of sight in the world frame: origin + z * direction is the point that the camera sees at
/// depth z (along its optical axis, map units).
struct Ray {
  Eigen::Vector3d origin, direction;

  Eigen::Vector3d at(double z) const { return origin + z * direction; }
};

/// The line of sight through a pixel of the picture as captured.
Ray rayThrough(const CameraModel& camera, const Pose& T_camera_world, const Eigen::Vector2d& pixel);

/// Depth at which a ray first meets the surface, or nothing.
std::optional<double> firstHit(const SurfaceMesh& mesh, const Ray& ray);

}  // namespace depthscope::platform
