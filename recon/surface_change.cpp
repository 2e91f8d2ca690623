#include "recon/surface_change.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace depthscope::recon {
namespace {

constexpr std::size_t kSamples = 4000;  // old vertices looked at

/// Vertices by cells of the size `reach`: those within it lie in the 27 cells around.
class VertexGrid {
 public:
  VertexGrid(const std::vector<Eigen::Vector3f>& vertices, float cell)
      : vertices_(vertices), cell_(cell) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      entries_.push_back({keyOf(cellOf(vertices[i])), static_cast<std::uint32_t>(i)});
    std::sort(entries_.begin(), entries_.end());
  }

  /// The nearest vertex within a cell's size, or -1.
  std::ptrdiff_t nearest(const Eigen::Vector3f& p) const {
    const Eigen::Vector3i middle = cellOf(p);
    float least = cell_ * cell_;
    std::ptrdiff_t found = -1;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const Entry first{keyOf(middle + Eigen::Vector3i(x, y, z)), 0};
          for (auto e = std::lower_bound(entries_.begin(), entries_.end(), first);
               e != entries_.end() && e->key == first.key; ++e) {
            const float d = (vertices_[e->vertex] - p).squaredNorm();
            if (d >= least) continue;
            least = d;
            found = e->vertex;
          }
        }
    return found;
  }

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t vertex;
    auto operator<=>(const Entry&) const = default;
  };
  Eigen::Vector3i cellOf(const Eigen::Vector3f& p) const {
    return (p / cell_).array().floor().cast<int>();
  }
  static std::uint64_t keyOf(const Eigen::Vector3i& c) {
    const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffff; };
    return part(c.x()) << 42 | part(c.y()) << 21 | part(c.z());
  }

  const std::vector<Eigen::Vector3f>& vertices_;
  float cell_;
  std::vector<Entry> entries_;
};

}  // namespace

SurfaceChange compareSurfaces(const SurfaceMesh& old_mesh, const SurfaceMesh& new_mesh, float limit,
                              float reach) {
  SurfaceChange change;
  if (old_mesh.vertices.empty() || new_mesh.vertices.empty() || !(reach > 0)) return change;
  const VertexGrid grid(new_mesh.vertices, reach);
  const std::size_t stride = old_mesh.vertices.size() / kSamples + 1;
  std::size_t compared = 0, beyond = 0;
  for (std::size_t i = 0; i < old_mesh.vertices.size(); i += stride) {
    const Eigen::Vector3f& p = old_mesh.vertices[i];
    const std::ptrdiff_t nearest = grid.nearest(p);
    if (nearest < 0) continue;
    const auto n = static_cast<std::size_t>(nearest);
    const float off = std::abs((p - new_mesh.vertices[n]).dot(new_mesh.normals[n]));
    ++compared;
    beyond += off > limit;
    change.largest = std::max(change.largest, off);
  }
  if (compared > 0) change.share_beyond = static_cast<float>(beyond) / static_cast<float>(compared);
  return change;
}

}  // namespace depthscope::recon
