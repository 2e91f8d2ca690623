#pragma once
#include "recon/dense/dense_settings.hpp"
#include "recon/dense/tsdf_volume.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// The zero level of a volume as triangles (surface nets, Gibson 1998: one vertex in each cell that
/// the surface passes, at the mean of its crossings of the cell's edges): fills vertices,
/// confidence, observations and triangles of `mesh`, counter-clockwise seen from the cameras. A
/// cell with a corner that no view saw, or of less than `min_confidence`, makes nothing: holes stay
/// holes.
void extractSurface(const TsdfVolume& volume, const DenseSettings& settings, SurfaceMesh& mesh);

}  // namespace depthscope::recon
