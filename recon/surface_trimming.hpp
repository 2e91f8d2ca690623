#pragma once
#include "recon/recon_settings.hpp"
#include "recon/support_cloud.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// Cuts `mesh` (vertices and triangles) down to what `support` (positions, oriented normals,
/// observations) bears out: a vertex stays when the nearest support point is no farther than
/// `trim_distance` times the spacing there and its normal agrees; holes of the observation stay
/// holes; small islands go. Fills normals, confidence and observations; turns triangles
/// counter-clockwise seen from the cameras.
void trimToSupport(SurfaceMesh& mesh, const SupportCloud::ConstPtr& support, float spacing,
                   const ReconSettings& settings);

}  // namespace depthscope::recon
