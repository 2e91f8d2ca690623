#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "types/surface_mesh.hpp"

namespace depthscope::recon {

using Triangle = std::array<std::uint32_t, 3>;  // indices into the vertices

/// Unit normal times twice the area of a triangle.
Eigen::Vector3f areaNormal(const SurfaceMesh& mesh, const Triangle& t);

/// Fills the unit vertex normals, each the area-weighted mean over its triangles.
void computeNormals(SurfaceMesh& mesh);

/// Drops connected pieces whose area is below `min_area` [map units^2] and the vertices, with their
/// confidence, that no triangle uses. Normals are not kept.
void dropSmallIslands(SurfaceMesh& mesh, float min_area);

}  // namespace depthscope::recon
