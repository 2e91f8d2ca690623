#include <algorithm>
#include <cmath>

#include "overlay/surface_prep.hpp"

namespace depthscope::overlay {
namespace {

constexpr float kCells = 44;                 // along the diagonal
constexpr std::size_t kTableSize = 1 << 16;  // hash table of cells, open addressing
constexpr std::uint32_t kEmpty = 0xffffffffu;

}  // namespace

/// Vertex clustering (Rossignac and Borrel 1993): all vertices of a cell of a regular grid become
/// their mean, and triangles that no longer have three corners fall away.
void SurfacePrep::cluster(const SurfaceMesh& mesh, PreparedSurface& out) {
  const float inverse = kCells / out.diagonal;
  const bool with_normals = mesh.normals.size() == mesh.vertices.size();
  cell_table_.assign(2 * kTableSize, kEmpty);  // key, cell
  cell_.assign(points_.size(), kEmpty);
  cell_position_.clear();
  cell_normal_.clear();
  cell_fade_.clear();
  cell_count_.clear();

  const auto cellOf = [&](std::uint32_t v) {
    if (cell_[v] != kEmpty) return cell_[v];
    // Coordinates are within half a diagonal of the origin: 7 bits each.
    const Eigen::Vector3f g = (points_[v] * inverse).array() + 0.5f * kCells;
    const auto key = static_cast<std::uint32_t>(g.x()) | static_cast<std::uint32_t>(g.y()) << 8 |
                     static_cast<std::uint32_t>(g.z()) << 16;
    std::size_t slot = (key * 2654435761u) >> 16;
    while (cell_table_[2 * slot] != key) {
      if (cell_table_[2 * slot] == kEmpty) {
        if (cell_position_.size() >= kTableSize / 2) return kEmpty;
        cell_table_[2 * slot] = key;
        cell_table_[2 * slot + 1] = static_cast<std::uint32_t>(cell_position_.size());
        cell_position_.push_back(Eigen::Vector3f::Zero());
        cell_normal_.push_back(Eigen::Vector3f::Zero());
        cell_fade_.push_back(0);
        cell_count_.push_back(0);
        break;
      }
      slot = (slot + 1) % kTableSize;
    }
    const std::uint32_t c = cell_table_[2 * slot + 1];
    cell_[v] = c;
    cell_position_[c] += points_[v];
    if (with_normals && mesh.normals[v].allFinite()) cell_normal_[c] += mesh.normals[v];
    cell_fade_[c] += fade_[v];
    cell_count_[c] += 1;
    return c;
  };
  for (const Triangle& t : triangles_) {
    const std::uint32_t a = cellOf(t[0]), b = cellOf(t[1]), c = cellOf(t[2]);
    if (a == b || b == c || c == a || a == kEmpty || b == kEmpty || c == kEmpty) continue;
    out.inset_indices.insert(out.inset_indices.end(), {a, b, c});
  }
  for (std::size_t i = 0; i < cell_position_.size(); ++i) {
    const Eigen::Vector3f p = cell_position_[i] / cell_count_[i];
    const Eigen::Vector3f n = cell_normal_[i].stableNormalized() * 127;
    out.inset_vertices.push_back(
        {{p.x(), p.y(), p.z()},
         {static_cast<std::int8_t>(std::lround(n.x())),
          static_cast<std::int8_t>(std::lround(n.y())),
          static_cast<std::int8_t>(std::lround(n.z()))},
         static_cast<std::uint8_t>(std::lround(255 * cell_fade_[i] / cell_count_[i]))});
  }
}

}  // namespace depthscope::overlay
