#include "recon/poisson_surface.hpp"

#include <pcl/common/common.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include "recon/poisson_octree.hpp"

namespace depthscope::recon {
namespace {

namespace kazhdan = pcl::poisson;

constexpr float kMinBoxScale = 1.1f;  // solver's cube over the points' bounding cube, at least
constexpr double kMarginCells = 2.5;  // free of points along each side of the cube: boxScale()
// The octree is full down to it. With 4 it had a tenth more nodes, all of them away from the
// points, and the surface was no more accurate.
constexpr int kFullDepth = 3;
constexpr int kNodePoolBlock = 1 << 12;   // octree nodes allocated at a time
constexpr int kSolverBlockDepth = 8;      // solve in blocks below it, to save memory
constexpr int kSolverMinIterations = 8;   // of conjugate gradients at each depth
constexpr double kSolverAccuracy = 1e-3;  // relative residual

/// Depth at which the density of the samples is estimated: coarser than the surface, so that it is
/// smooth.
int densityDepth(int depth) {
  return depth - 2;
}

/// Solver's cube over the bounding cube of the points. PCL's screening term reads past the end of
/// its table of B-splines for points in the two outermost cells (multi_grid_octree_data.hpp,
/// SetMatrixRow): keep those free.
float boxScale(int depth) {
  const double cells = 1 << depth;
  return std::max(kMinBoxScale, static_cast<float>(cells / (cells - 2 * kMarginCells)));
}

}  // namespace

int poissonDepth(const SupportCloud& cloud, float spacing, const ReconSettings& settings) {
  pcl::PointNormal low, high;
  pcl::getMinMax3D(cloud, low, high);
  const float side = (high.getVector3fMap() - low.getVector3fMap()).maxCoeff();
  const double wanted = settings.poisson_cell * spacing;
  int depth = settings.poisson_min_depth;
  while (depth < settings.poisson_max_depth && side * boxScale(depth) / (1 << depth) > wanted)
    ++depth;
  return depth;
}

// PCL's octree is driven directly: its pcl::Poisson compiles the solver for five spline degrees, of
// which only the second is wanted.
SurfaceMesh poissonSurface(const SupportCloud::ConstPtr& cloud, int depth,
                           const ReconSettings& settings) {
  static std::mutex pool_mutex;
  const std::lock_guard lock(pool_mutex);
  kazhdan::TreeNodeData::UseIndex = 1;
  kazhdan::TreeOctNode::SetAllocator(kNodePoolBlock);
  PoissonOctree tree(settings.threads);
  tree.setBSplineData(depth, 1.f / static_cast<float>(1 << depth), true);
  kazhdan::Point3D<float> corner;
  float scale = 1;
  tree.setTree<pcl::PointNormal>(
      cloud, depth, std::min(depth, kFullDepth), densityDepth(depth),
      static_cast<float>(settings.poisson_samples_per_node), boxScale(depth), corner, scale,
      /*useConfidence=*/0, static_cast<float>(settings.poisson_point_weight),
      /*adaptiveWeights=*/true);
  tree.ClipTree();
  tree.finalize();
  tree.setConstraintsAndTables();
  // It means to free this table but does not, and the next stage takes a new one.
  delete[] tree.fData.dvDotTable;
  tree.fData.dvDotTable = nullptr;
  tree.LaplacianMatrixIteration(kSolverBlockDepth, false, kSolverMinIterations, kSolverAccuracy);
  kazhdan::CoredVectorMeshData extracted;
  tree.GetMCIsoTriangles(tree.GetIsoValue(), 0, &extracted);

  SurfaceMesh mesh;
  const auto inner = static_cast<int>(extracted.inCorePoints.size());
  const auto toMap = [&](const kazhdan::Point3D<float>& p) {
    return Eigen::Vector3f(p.coords[0] * scale + corner.coords[0],
                           p.coords[1] * scale + corner.coords[1],
                           p.coords[2] * scale + corner.coords[2]);
  };
  for (const auto& p : extracted.inCorePoints) mesh.vertices.push_back(toMap(p));
  extracted.resetIterator();
  kazhdan::Point3D<float> point;
  while (extracted.nextOutOfCorePoint(point)) mesh.vertices.push_back(toMap(point));
  std::vector<kazhdan::CoredVertexIndex> polygon;
  while (extracted.nextPolygon(polygon)) {
    std::array<std::uint32_t, 3> t{};
    for (std::size_t k = 0; k < t.size(); ++k)
      t[k] = static_cast<std::uint32_t>(polygon[k].idx + (polygon[k].inCore ? 0 : inner));
    mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace depthscope::recon
