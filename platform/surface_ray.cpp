#include "platform/surface_ray.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace depthscope::platform {
namespace {

constexpr double miss = std::numeric_limits<double>::infinity();

/// Depth of a triangle along the ray, or `miss` (Moeller, Trumbore 1997).
double depthOf(const Ray& ray, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
               const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, p = ray.direction.cross(ac);
  const double det = ab.dot(p);
  if (std::abs(det) < 1e-300) return miss;
  const Eigen::Vector3d to_origin = ray.origin - a;
  const double u = to_origin.dot(p) / det;
  const Eigen::Vector3d q = to_origin.cross(ab);
  const double v = ray.direction.dot(q) / det;
  const double z = ac.dot(q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && z > 0 ? z : miss;
}

}  // namespace

Ray rayThrough(const CameraModel& camera, const Pose& T_camera_world,
               const Eigen::Vector2d& pixel) {
  const Pose T_world_camera = T_camera_world.inverse();
  return {T_world_camera.t, T_world_camera.R * camera.unproject(pixel).homogeneous()};
}

std::optional<double> firstHit(const SurfaceMesh& mesh, const Ray& ray) {
  const auto vertex = [&](std::uint32_t i) -> Eigen::Vector3d {
    return mesh.vertices[i].cast<double>();
  };
  double nearest = miss;
  for (const auto& t : mesh.triangles)
    nearest = std::min(nearest, depthOf(ray, vertex(t[0]), vertex(t[1]), vertex(t[2])));
  if (!std::isfinite(nearest)) return std::nullopt;
  return nearest;
}

}  // namespace depthscope::platform
