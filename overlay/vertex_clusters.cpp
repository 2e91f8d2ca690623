#include "overlay/vertex_clusters.hpp"

#include <algorithm>

namespace depthscope::overlay {
namespace {

constexpr std::uint32_t kTableBits = 17;
constexpr std::uint32_t kTableSize = 1u << kTableBits;
constexpr std::uint32_t kEmpty = 0xffffffffu;
constexpr int kKeyBits = 10;  // of each coordinate, enough for max_cells

}  // namespace

void FadingMesh::clear() {
  points.clear();
  normals.clear();
  fade.clear();
  triangles.clear();
}

/// The number of the cell with this key, a new one where it is seen for the first time; kEmpty when
/// there is no room.
std::uint32_t VertexClusters::cellOf(std::uint32_t key) {
  std::uint32_t slot = (key * 2654435761u) >> (32 - kTableBits);
  while (keys_[slot] != key) {
    if (keys_[slot] == kEmpty) {
      if (used_ >= kTableSize / 2) return kEmpty;
      keys_[slot] = key;
      cells_[slot] = used_++;
      break;
    }
    slot = (slot + 1) % kTableSize;
  }
  return cells_[slot];
}

bool VertexClusters::reduce(const FadingMesh& in, float cell, float diagonal, FadingMesh& out) {
  const float inverse = 1 / std::max(cell, diagonal / max_cells);
  const float half = 0.5f * diagonal * inverse;
  keys_.assign(kTableSize, kEmpty);
  cells_.resize(kTableSize);
  cell_of_.assign(in.points.size(), kEmpty);
  count_.clear();
  used_ = 0;
  out.clear();

  const auto take = [&](std::uint32_t v) {
    if (cell_of_[v] != kEmpty) return cell_of_[v];
    // Coordinates are within half a diagonal of the origin.
    const Eigen::Vector3f g = (in.points[v] * inverse).array() + half;
    const std::uint32_t c =
        cellOf(static_cast<std::uint32_t>(g.x()) | static_cast<std::uint32_t>(g.y()) << kKeyBits |
               static_cast<std::uint32_t>(g.z()) << 2 * kKeyBits);
    if (c == kEmpty) return c;
    if (c == out.points.size()) {
      out.points.push_back(Eigen::Vector3f::Zero());
      out.normals.push_back(Eigen::Vector3f::Zero());
      out.fade.push_back(0);
      count_.push_back(0);
    }
    cell_of_[v] = c;
    out.points[c] += in.points[v];
    out.normals[c] += in.normals[v];
    out.fade[c] += in.fade[v];
    count_[c] += 1;
    return c;
  };
  for (const auto& t : in.triangles) {
    const std::uint32_t a = take(t[0]), b = take(t[1]), c = take(t[2]);
    if (a == kEmpty || b == kEmpty || c == kEmpty) return false;
    if (a != b && b != c && c != a) out.triangles.push_back({a, b, c});
  }
  for (std::size_t i = 0; i < out.points.size(); ++i) {
    out.points[i] /= count_[i];
    out.normals[i] = out.normals[i].stableNormalized();
    out.fade[i] /= count_[i];
  }
  return true;
}

}  // namespace depthscope::overlay
