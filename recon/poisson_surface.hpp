#pragma once
#include "recon/recon_settings.hpp"
#include "recon/support_cloud.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// The least octree depth whose finest cell is no larger than `poisson_cell`, within the bounds of
/// the settings.
int poissonDepth(const SupportCloud& cloud, float spacing, const ReconSettings& settings);

/// Screened Poisson surface (paper, section 3.3; Kazhdan and Hoppe 2013) through oriented points:
/// fills `vertices` and `triangles` of the result, counter-clockwise seen from where the normals
/// point. The surface is closed or ends at the solver's box, so it needs trimming. `depth` is 3 at
/// least. Not re-entrant: PCL keeps its octree nodes in a static pool, so calls are serialized.
SurfaceMesh poissonSurface(const SupportCloud::ConstPtr& cloud, int depth,
                           const ReconSettings& settings);

}  // namespace depthscope::recon
