#pragma once
#include <iosfwd>

#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// Writes a surface as binary little-endian PLY: x y z nx ny nz confidence, triangles. Equal meshes
/// give equal bytes. An empty mesh gives a valid file without vertices.
void writePly(std::ostream& out, const SurfaceMesh& mesh);

}  // namespace depthscope::platform
