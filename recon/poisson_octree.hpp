#pragma once
#include <pcl/point_types.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <unordered_map>
#include <utility>
#include <vector>

#include "recon/threads.hpp"

// The octree prints its troubles with ambiguous cells, but standard output belongs to our programs.
#define printf(...) ((void)0)
// The octree's header leans on those before it: this order is needed.
// clang-format off
#include <pcl/surface/3rdparty/poisson4/octree_poisson.h>
#include <pcl/surface/3rdparty/poisson4/sparse_matrix.h>
#include <pcl/surface/3rdparty/poisson4/function_data.h>
#include <pcl/surface/3rdparty/poisson4/ppolynomial.h>
#include <pcl/surface/3rdparty/poisson4/multi_grid_octree_data.h>
#include <pcl/surface/3rdparty/poisson4/geometry.h>
// clang-format on
#undef printf

namespace depthscope::recon {

/// PCL's octree of screened Poisson reconstruction, for one source file: its headers define
/// functions that are not inline. Its own threads (OpenMP) add up partial sums in an order that
/// depends on how many they are, end the program where memory runs out, and count on no
/// MemoryMeter. Two members of `Octree<2>` that take much of the time are therefore written anew
/// below. They need what is kept here: no octree of another class may call them.
class PoissonOctree : public pcl::poisson::Octree<2> {
 public:
  /// The work is shared by `worker_threads`; the surface does not depend on how many.
  explicit PoissonOctree(int worker_threads) : workers(worker_threads) { threads = 1; }

  /// Sets the constraints and meanwhile the tables: neither needs the other. The tree is final.
  void setConstraintsAndTables();

  const int workers;
  pcl::poisson::SortedTreeNodes::CornerTableData corner_table;
  pcl::poisson::SortedTreeNodes::EdgeTableData edge_table;
};

}  // namespace depthscope::recon

namespace pcl::poisson {

/// System of equations of one depth, rows on threads: each is of one node and changes only that.
template <>
inline int Octree<2>::GetFixedDepthLaplacian(SparseSymmetricMatrix<Real>& matrix, int depth,
                                             const SortedTreeNodes& nodes, Real* coarser_solution) {
  constexpr int kMaxEntries = 63;  // of a row: half of 5^3 neighbours, and the node itself
  const int first = nodes.nodeCount[depth], rows = nodes.nodeCount[depth + 1] - first;
  double same_depth[5][5][5];
  SetLaplacianStencil(depth, same_depth);
  Stencil<double, 5> next_coarser[2][2][2];
  SetLaplacianStencils(depth, next_coarser);
  matrix.Resize(rows);
  for (int row = 0; row < rows; ++row) matrix.SetRowSize(row, kMaxEntries);  // from a shared pool
  const auto setRows = [&](std::size_t begin, std::size_t end) {
    TreeOctNode::NeighborKey5 neighbours;
    neighbours.set(depth);
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      TreeOctNode* const node = nodes.treeNodes[first + row];
      neighbours.getNeighbors(node);
      matrix.rowSizes[row] =
          SetMatrixRow(neighbours.neighbors[depth], matrix[row], first, same_depth);
      int x = 0, y = 0, z = 0;
      if (node->parent != nullptr)
        Cube::FactorCornerIndex(static_cast<int>(node - node->parent->children), x, y, z);
      UpdateConstraintsFromCoarser(neighbours, node, coarser_solution, next_coarser[x][y][z]);
    }
  };
  depthscope::recon::onRanges(static_cast<const depthscope::recon::PoissonOctree&>(*this).workers,
                              static_cast<std::size_t>(rows), setRows);
  return 1;
}

/// The surface where the solution is `iso_value`, of the whole tree at once, by tables that are
/// there already.
template <>
inline void Octree<2>::GetMCIsoTriangles(Real iso_value, int, CoredMeshData* mesh, int,
                                         int nonlinear_fit, bool, bool polygons) {
  fData.setValueTables(fData.VALUE_FLAG | fData.D_VALUE_FLAG, 0, postNormalSmooth);
  const int deepest = tree.maxDepth();
  const auto count = [&](int depth) { return static_cast<std::size_t>(_sNodes.nodeCount[depth]); };
  std::vector<Real> solution(count(deepest), 0);
  for (std::size_t i = count(_minDepth); i < count(deepest); ++i)
    solution[i] = _sNodes.treeNodes[i]->nodeData.solution;
  for (int depth = 0; depth < deepest; ++depth) UpSample(depth, _sNodes, solution.data());
  for (std::size_t i = 0; i < count(deepest + 1); ++i) _sNodes.treeNodes[i]->nodeData.mcIndex = 0;

  const auto& tables = static_cast<const depthscope::recon::PoissonOctree&>(*this);
  RootData roots;
  static_cast<SortedTreeNodes::CornerTableData&>(roots) = tables.corner_table;
  static_cast<SortedTreeNodes::EdgeTableData&>(roots) = tables.edge_table;
  const auto corners = static_cast<std::size_t>(roots.cCount);
  const auto edges = static_cast<std::size_t>(roots.eCount);
  std::vector<Real> values(corners);
  std::vector<Point3D<Real>> normals_at(corners);
  std::vector<int> edge_roots(edges);
  std::vector<char> values_set(corners, 0), normals_set(corners, 0), edges_set(edges, 0);
  std::unordered_map<long long, std::pair<Real, Point3D<Real>>> boundary_values;
  roots.cornerValues = values.data();
  roots.cornerNormals = normals_at.data();
  roots.interiorRoots = edge_roots.data();
  roots.cornerValuesSet = values_set.data();
  roots.cornerNormalsSet = normals_set.data();
  roots.edgesSet = edges_set.data();
  roots.boundaryValues = &boundary_values;

  TreeOctNode::ConstNeighborKey3 neighbours3;
  TreeOctNode::ConstNeighborKey5 neighbours5;
  neighbours3.set(deepest);
  neighbours5.set(deepest);
  std::vector<Point3D<float>> inner;
  for (int depth = deepest; depth > 0; --depth) {  // a coarser cell needs its finer neighbours
    Stencil<double, 3> same_depth[8], next_coarser[8][8];
    SetEvaluationStencils(depth, same_depth, next_coarser);
    std::vector<TreeOctNode*> crossed;
    for (std::size_t i = count(depth); i < count(depth + 1); ++i) {
      TreeOctNode* const leaf = _sNodes.treeNodes[i];
      if (leaf->children != nullptr) continue;
      SetIsoCorners(iso_value, leaf, roots, roots.cornerValuesSet, roots.cornerValues, neighbours3,
                    solution.data(), same_depth, next_coarser);
      if (!MarchingCubes::HasRoots(leaf->nodeData.mcIndex)) continue;
      SetMCRootPositions(leaf, 0, iso_value, neighbours5, roots, &inner, mesh, solution.data(),
                         nonlinear_fit);
      crossed.push_back(leaf);
    }
    for (TreeOctNode* leaf : crossed)
      GetMCIsoTriangles(leaf, mesh, roots, &inner, 0, 0, polygons, nullptr);
  }
}

}  // namespace pcl::poisson

namespace depthscope::recon {

inline void PoissonOctree::setConstraintsAndTables() {
  pcl::poisson::SortedTreeNodes nodes;
  nodes.set(tree);
  onRanges(workers, 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t job = begin; job < end; ++job) {
      if (job == 0) {
        SetLaplacianConstraints();
      } else {
        nodes.setCornerTable(corner_table, &tree, threads);
        nodes.setEdgeTable(edge_table, &tree, threads);
      }
    }
  });
}

}  // namespace depthscope::recon
