#pragma once
#include <iosfwd>
#include <optional>
#include <string_view>

#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// Files that a surface can be handed out as, in the unit of length of its map.
enum class SurfaceFormat {
  Ply,  // binary little-endian: x y z nx ny nz confidence, triangles
  Obj,  // text: vertices, normals, triangles
  Stl,  // binary: triangles with their normals
};

/// By the end of a file's name, without the dot: "ply", "obj" or "stl" in any case; else none.
std::optional<SurfaceFormat> surfaceFormat(std::string_view extension);

/// Writes a surface; the header says that it is right up to scale only. Equal meshes give equal
/// bytes. An empty mesh gives a valid file without vertices.
void writeSurface(std::ostream& out, const SurfaceMesh& mesh, SurfaceFormat format);

}  // namespace depthscope::platform
