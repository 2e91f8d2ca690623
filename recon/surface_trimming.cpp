#include "recon/surface_trimming.hpp"

#include <pcl/kdtree/kdtree_flann.h>

#include <algorithm>
#include <cmath>

#include "recon/mesh_geometry.hpp"
#include "recon/point_filters.hpp"
#include "recon/threads.hpp"

namespace depthscope::recon {
namespace {

constexpr int kSupportNeighbours = 8;  // support points a vertex is judged by

/// What the support says about one vertex.
struct VertexSupport {
  bool within = false;                               // near enough to a support point
  float confidence = 0;                              // 0..1
  float observations = 0;                            // of the nearest support point
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // of the support around it, not unit
};

/// By the support points `found`, the nearest first.
VertexSupport judge(const SupportCloud& support, const std::vector<float>& local_spacing,
                    const pcl::Indices& found, const std::vector<float>& squared, float spacing,
                    const ReconSettings& settings) {
  VertexSupport out;
  float evidence = 0;
  if (!found.empty()) out.observations = support[static_cast<std::size_t>(found[0])].curvature;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto i = static_cast<std::size_t>(found[k]);
    const float reach = static_cast<float>(settings.trim_distance) * local_spacing[i];
    if (std::sqrt(squared[k]) <= reach) out.within = true;
    const float weight = std::exp(-squared[k] / (2 * spacing * spacing));
    evidence += weight * support[i].curvature;
    out.normal += (weight + 1e-6f) * support[i].getNormalVector3fMap();
  }
  out.confidence = std::min(1.f, evidence / static_cast<float>(settings.full_confidence_support));
  return out;
}

std::vector<VertexSupport> judgeVertices(const SurfaceMesh& mesh,
                                         const SupportCloud::ConstPtr& support, float spacing,
                                         const ReconSettings& settings) {
  std::vector<float> local =
      neighbourDistances(support, settings.spacing_neighbours, settings.threads);
  for (float& l : local)
    l = std::clamp(l, spacing, static_cast<float>(settings.trim_max_spacing) * spacing);

  pcl::KdTreeFLANN<pcl::PointNormal> tree;
  tree.setInputCloud(support);
  std::vector<VertexSupport> out(mesh.vertices.size());
  onRanges(settings.threads, out.size(), [&](std::size_t begin, std::size_t end) {
    pcl::Indices found;
    std::vector<float> squared;
    for (std::size_t v = begin; v < end; ++v) {
      pcl::PointNormal query;
      query.getVector3fMap() = mesh.vertices[v];
      tree.nearestKSearch(query, kSupportNeighbours, found, squared);
      out[v] = judge(*support, local, found, squared, spacing, settings);
    }
  });
  return out;
}

/// Poisson's own winding is a convention of its code; the support decides it for the mesh as a
/// whole.
void windTowardsSupport(SurfaceMesh& mesh, const std::vector<VertexSupport>& judged) {
  double agreement = 0;
  for (const Triangle& t : mesh.triangles)
    if (judged[t[0]].within) agreement += areaNormal(mesh, t).dot(judged[t[0]].normal);
  if (agreement >= 0) return;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace

void trimToSupport(SurfaceMesh& mesh, const SupportCloud::ConstPtr& support, float spacing,
                   const ReconSettings& settings) {
  if (mesh.empty() || support->empty()) return mesh.clear();
  const std::vector<VertexSupport> judged = judgeVertices(mesh, support, spacing, settings);
  windTowardsSupport(mesh, judged);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Eigen::Vector3f normal = areaNormal(mesh, t);
    return !std::all_of(t.begin(), t.end(), [&](std::uint32_t v) {
      // A sheet that faces away from the cameras is the far side of Poisson's closed surface.
      return judged[v].within && normal.dot(judged[v].normal) > 0;
    });
  });
  mesh.confidence.resize(mesh.vertices.size());
  std::transform(judged.begin(), judged.end(), mesh.confidence.begin(),
                 [](const VertexSupport& s) { return s.confidence; });
  mesh.observations.resize(mesh.vertices.size());
  std::transform(judged.begin(), judged.end(), mesh.observations.begin(),
                 [](const VertexSupport& s) {
                   return static_cast<std::uint16_t>(std::lround(s.observations));
                 });
  dropSmallIslands(mesh, static_cast<float>(settings.min_island_area) * spacing * spacing);
  computeNormals(mesh);
}

}  // namespace depthscope::recon
