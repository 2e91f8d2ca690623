#pragma once
#include <filesystem>

#include "types/sparse_cloud.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// Writes the sparse points as binary little-endian PLY: `x y z` (float, map units), `nx ny nz`
/// (unit, towards the cameras), `observations` (int), `reprojection_error` (float, px). Atomic: a
/// reader sees the old file or the new one, never half of it. Throws InputError when the file
/// cannot be created, std::runtime_error when the disk fails later.
void writePly(const std::filesystem::path& path, const SparseCloud& cloud);

/// Reads the surface in a PLY file (ascii or binary little-endian; polygons are split into
/// triangles; other elements and properties are skipped). Normals are computed and confidence is 1
/// where the file has none; no faces makes a mesh without triangles. Throws InputError naming the
/// file and what is wrong with it: unreadable, not PLY, cut short, a number that is not finite, an
/// index out of range.
SurfaceMesh readPly(const std::filesystem::path& path);

}  // namespace depthscope::recon
