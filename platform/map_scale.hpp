#pragma once
#include <Eigen/Core>
#include <string>
#include <string_view>

#include "types/camera_model.hpp"
#include "types/pose.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// A known length that was picked in a picture.
struct ScaleRequest {
  enum class Kind {
    Length,    // between two points of the tissue: of a target or ruler that lies on it
    Diameter,  // across the shaft of an instrument, where it touches the tissue
  };
  Kind kind = Kind::Length;
  double mm = 0;
  Eigen::Vector2d a = Eigen::Vector2d::Zero(), b = a;  // [px] in the picture as captured
};

/// Parses `[diameter] MM X1,Y1 X2,Y2`. Throws InputError.
ScaleRequest parseScaleRequest(std::string_view text);
/// Throws InputError unless both points lie in the camera's picture.
void requireInPicture(const ScaleRequest& request, const CameraModel& camera);

/// How long the unit of length of a monocular map is.
struct MapScale {
  std::uint32_t map_id = 0;
  double mm_per_unit = 0;
  double uncertainty_mm = 0;  // standard deviation of mm_per_unit; see measureScale()
  ScaleRequest from;
};

/// "23.41 mm per unit +- 0.35".
std::string toString(const MapScale& scale);
/// What a scale was measured by: "10 mm between two points".
std::string toString(const ScaleRequest& request);

/// The scale of the surface's map by a length picked in the picture taken from `T_camera_world`.
///
/// Length: `mm` over the distance between the points of the surface seen there. Diameter: both
/// lines of sight are taken to the depth of the surface under the middle between them.
///
/// The uncertainty is that of picking, 1.5 px in x and y at each end, as the surface carries it on
/// to the length. Of a shaft it is not known besides whether it lies on the tissue or reaches into
/// it, which is one radius of depth. How far the surface itself is wrong is not in it.
///
/// Throws InputError (one line) where a point misses the surface, where the uncertainty is more
/// than a quarter, and where the tissue would be nearer than 1 mm or farther than 500 mm by it.
MapScale measureScale(const SurfaceMesh& mesh, const CameraModel& camera,
                      const Pose& T_camera_world, const ScaleRequest& request);

}  // namespace depthscope::platform
