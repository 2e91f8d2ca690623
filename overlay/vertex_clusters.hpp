#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace depthscope::overlay {

/// A mesh on its way to the graphics card. Arrays of vertices are parallel.
struct FadingMesh {
  std::vector<Eigen::Vector3f> points;   // relative to the centre of the bounding box
  std::vector<Eigen::Vector3f> normals;  // zero where unknown
  std::vector<float> fade;               // visibility 0..1
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void clear();
};

/// Makes meshes coarser by vertex clustering (Rossignac and Borrel, "Multi-resolution 3D
/// approximations for rendering complex scenes", 1993): all vertices of a cell of a regular grid
/// become their mean, and triangles that no longer have three corners fall away. Linear; keeps its
/// memory from one mesh to the next.
class VertexClusters {
 public:
  /// Cells across the bounding box's diagonal may not be smaller than 1 / max_cells of it.
  static constexpr float max_cells = 1000;

  /// False when the mesh fills more cells than there is room for; `out` is of no use then. `cell`:
  /// size of the cells; `diagonal`: of the bounding box of `in`.
  bool reduce(const FadingMesh& in, float cell, float diagonal, FadingMesh& out);

 private:
  std::uint32_t cellOf(std::uint32_t key);

  std::vector<std::uint32_t> keys_, cells_;  // hash table, open addressing
  std::vector<std::uint32_t> cell_of_;       // of each vertex
  std::vector<float> count_;                 // vertices of each cell
  std::uint32_t used_ = 0;
};

}  // namespace depthscope::overlay
