#include "platform/label_anchor.hpp"

#include <cmath>

#include "platform/surface_ray.hpp"
#include "types/error.hpp"

namespace depthscope::platform {
namespace {

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
  const Ray ray = rayThrough(camera, T_camera_world, pixel);
  const auto depth = firstHit(mesh, ray);
  if (!depth) return std::nullopt;
  return ray.at(*depth).cast<float>();
}

}  // namespace depthscope::platform
