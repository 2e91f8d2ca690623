#include "recon/mesh_geometry.hpp"

#include <Eigen/Geometry>
#include <numeric>
#include <vector>

namespace depthscope::recon {
namespace {

/// Renumbers vertices so that only those used by triangles remain, in their old order.
void compact(SurfaceMesh& mesh) {
  constexpr std::uint32_t kUnused = 0xffffffff;
  std::vector<std::uint32_t> renumbered(mesh.vertices.size(), kUnused);
  for (const Triangle& t : mesh.triangles)
    for (std::uint32_t v : t) renumbered[v] = 0;
  const bool has_confidence = mesh.confidence.size() == mesh.vertices.size();
  const bool has_observations = mesh.observations.size() == mesh.vertices.size();
  std::uint32_t next = 0;
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == kUnused) continue;
    mesh.vertices[next] = mesh.vertices[v];
    if (has_confidence) mesh.confidence[next] = mesh.confidence[v];
    if (has_observations) mesh.observations[next] = mesh.observations[v];
    renumbered[v] = next++;
  }
  mesh.vertices.resize(next);
  if (has_confidence) mesh.confidence.resize(next);
  if (has_observations) mesh.observations.resize(next);
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = renumbered[v];
}

std::uint32_t findRoot(std::vector<std::uint32_t>& parent, std::uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

}  // namespace

Eigen::Vector3f areaNormal(const SurfaceMesh& mesh, const Triangle& t) {
  const Eigen::Vector3f& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

void computeNormals(SurfaceMesh& mesh) {
  mesh.normals.assign(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Eigen::Vector3f n = areaNormal(mesh, t);
    for (std::uint32_t v : t) mesh.normals[v] += n;
  }
  for (Eigen::Vector3f& n : mesh.normals) {
    const float length = n.norm();
    n = length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f::UnitZ();
  }
}

void dropSmallIslands(SurfaceMesh& mesh, float min_area) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  for (const Triangle& t : mesh.triangles)
    for (int k = 1; k < 3; ++k)
      parent[findRoot(parent, t[static_cast<std::size_t>(k)])] = findRoot(parent, t[0]);
  std::vector<float> area(mesh.vertices.size(), 0.f);
  for (const Triangle& t : mesh.triangles)
    area[findRoot(parent, t[0])] += 0.5f * areaNormal(mesh, t).norm();
  std::erase_if(mesh.triangles,
                [&](const Triangle& t) { return area[findRoot(parent, t[0])] < min_area; });
  compact(mesh);
}

}  // namespace depthscope::recon
