#pragma once
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// How far a new surface lies from the one that it replaces, where both are.
struct SurfaceChange {
  float largest = 0;       // [map unit] along the new surface's normal
  float share_beyond = 0;  // of the old vertices, that lie farther off than the limit
};

/// Compares two surfaces of one map: each old vertex with the nearest new one, where there is one
/// within `reach` [map unit]. `limit` [map unit]. Old vertices are sampled evenly, so that time is
/// bounded.
SurfaceChange compareSurfaces(const SurfaceMesh& old_mesh, const SurfaceMesh& new_mesh, float limit,
                              float reach);

}  // namespace depthscope::recon
