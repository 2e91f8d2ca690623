#include "platform/label_anchor.hpp"

#include <cmath>
#include <limits>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

/// Distance along the ray origin + s * direction to a triangle, or infinity (Moeller, Trumbore
/// 1997).
double rayTriangle(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                   const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  constexpr double miss = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d ab = b - a, ac = c - a, p = direction.cross(ac);
  const double det = ab.dot(p);
  if (std::abs(det) < 1e-300) return miss;
  const Eigen::Vector3d to_origin = origin - a;
  const double u = to_origin.dot(p) / det;
  const Eigen::Vector3d q = to_origin.cross(ab);
  const double v = direction.dot(q) / det;
  const double s = ac.dot(q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && s > 0 ? s : miss;
}

double parseCoordinate(std::string_view text, std::string_view argument) {
  std::size_t used = 0;
  double value = NAN;
  try {
    value = std::stod(std::string(text), &used);
  } catch (const std::exception&) {
  }
  if (text.empty() || used != text.size() || !std::isfinite(value))
    throw InputError("--label " + std::string(argument) +
                     ": expected TEXT@X,Y with X, Y in pixels");
  return value;
}

}  // namespace

LabelRequest parseLabelRequest(std::string_view argument) {
  const auto at = argument.rfind('@');
  const auto comma = argument.rfind(',');
  if (at == std::string_view::npos || at == 0 || comma == std::string_view::npos || comma < at)
    throw InputError("--label " + std::string(argument) +
                     ": expected TEXT@X,Y with X, Y in pixels");
  return {std::string(argument.substr(0, at)),
          {parseCoordinate(argument.substr(at + 1, comma - at - 1), argument),
           parseCoordinate(argument.substr(comma + 1), argument)}};
}

std::optional<Eigen::Vector3f> anchorOnSurface(const SurfaceMesh& mesh, const CameraModel& camera,
                                               const Pose& T_camera_world,
                                               const Eigen::Vector2d& pixel) {
  const Pose T_world_camera = T_camera_world.inverse();
  const Eigen::Vector3d origin = T_world_camera.t;
  const Eigen::Vector3d direction = T_world_camera.R * camera.unproject(pixel).homogeneous();
  double nearest = std::numeric_limits<double>::infinity();
  const auto vertex = [&](std::uint32_t i) -> Eigen::Vector3d {
    return mesh.vertices[i].cast<double>();
  };
  for (const auto& t : mesh.triangles)
    nearest =
        std::min(nearest, rayTriangle(origin, direction, vertex(t[0]), vertex(t[1]), vertex(t[2])));
  if (!std::isfinite(nearest)) return std::nullopt;
  return (origin + nearest * direction).cast<float>();
}

}  // namespace depthscope::platform
