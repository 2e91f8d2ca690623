#pragma once
#include "recon/mesh_geometry.hpp"

namespace depthscope::recon {

/// Of all triangles [map units^2].
inline double area(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += 0.5 * areaNormal(mesh, t).norm();
  return sum;
}

}  // namespace depthscope::recon
