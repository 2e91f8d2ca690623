#pragma once
#include <iosfwd>
#include <optional>
#include <string_view>

#include "platform/map_scale.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::platform {

/// Files that a surface can be handed out as.
enum class SurfaceFormat {
  Ply,  // binary little-endian: x y z nx ny nz confidence [red green blue] [observations],
        // triangles
  Obj,  // text: vertices, with r g b (0..1) after x y z where there are colours; normals, triangles
  Stl,  // binary: triangles with their normals
};

/// By the end of a file's name, without the dot: "ply", "obj" or "stl" in any case; else none.
std::optional<SurfaceFormat> surfaceFormat(std::string_view extension);

/// What coordinates are written in where the scale of the map is known.
enum class Lengths { Millimetres, MapUnits };

/// Writes a surface. Without a `scale` coordinates are in the map's unit, and the header says that
/// they are right up to scale only; else it says the scale, and what they are in. Equal meshes give
/// equal bytes. An empty mesh gives a valid file without vertices.
void writeSurface(std::ostream& out, const SurfaceMesh& mesh, SurfaceFormat format,
                  const std::optional<MapScale>& scale = std::nullopt,
                  Lengths lengths = Lengths::Millimetres);

}  // namespace depthscope::platform
