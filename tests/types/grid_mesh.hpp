#pragma once
#include <cstdint>

#include "types/surface_mesh.hpp"

namespace depthscope {

/// n x n squares, each of two triangles. Their corners are `at(u, v)`, row by row; u and v run from
/// 0 to 1. Normals point along -z, confidence is 1.
template <class Place>
SurfaceMesh gridMesh(std::uint32_t n, Place&& at) {
  SurfaceMesh mesh;
  for (std::uint32_t r = 0; r <= n; ++r)
    for (std::uint32_t c = 0; c <= n; ++c)
      mesh.vertices.push_back(at(static_cast<float>(c) / static_cast<float>(n),
                                 static_cast<float>(r) / static_cast<float>(n)));
  mesh.normals.assign(mesh.vertices.size(), {0, 0, -1});
  mesh.confidence.assign(mesh.vertices.size(), 1);
  for (std::uint32_t r = 0; r < n; ++r)
    for (std::uint32_t c = 0; c < n; ++c) {
      const std::uint32_t a = r * (n + 1) + c, b = a + n + 1;
      mesh.triangles.push_back({a, b, a + 1});
      mesh.triangles.push_back({a + 1, b, b + 1});
    }
  return mesh;
}

/// Adds a mesh to another, connected nowhere.
inline void append(SurfaceMesh& to, const SurfaceMesh& m) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), m.vertices.begin(), m.vertices.end());
  to.normals.insert(to.normals.end(), m.normals.begin(), m.normals.end());
  to.confidence.insert(to.confidence.end(), m.confidence.begin(), m.confidence.end());
  for (const auto& t : m.triangles)
    to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace depthscope
