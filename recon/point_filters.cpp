#include "recon/point_filters.hpp"

#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recon/threads.hpp"

namespace depthscope::recon {
namespace {

bool usable(const SparsePoint& p, const ReconSettings& settings) {
  // A view direction of no length cannot orient a normal.
  return p.position.allFinite() && p.view_direction.allFinite() &&
         p.view_direction.squaredNorm() > 0.25f && p.observations >= settings.min_observations &&
         p.reprojection_error_px <= settings.max_reprojection_error_px;
}

/// Removes from `index` the points that are `max_distance` times farther from the median centre
/// than the median point is.
void dropFar(const SparseCloud& cloud, double max_distance, std::vector<std::size_t>& index) {
  Eigen::Vector3f centre;
  std::vector<float> values(index.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < index.size(); ++i)
      values[i] = cloud.points[index[i]].position[axis];
    centre[axis] = median(values);
  }
  for (std::size_t i = 0; i < index.size(); ++i)
    values[i] = (cloud.points[index[i]].position - centre).stableNorm();
  const float limit = static_cast<float>(max_distance) * median(values);
  std::erase_if(index, [&](std::size_t i) {
    return (cloud.points[i].position - centre).stableNorm() > limit;
  });
}

pcl::PointNormal toSupport(const SparsePoint& p) {
  pcl::PointNormal s;
  s.getVector3fMap() = p.position;
  s.getNormalVector3fMap() = p.view_direction.normalized();
  s.curvature = static_cast<float>(p.observations);
  return s;
}

}  // namespace

SupportCloud::Ptr usablePoints(const SparseCloud& cloud, const ReconSettings& settings) {
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (usable(cloud.points[i], settings)) index.push_back(i);
  dropFar(cloud, settings.max_distance, index);
  const auto limit = static_cast<std::size_t>(std::max(0, settings.max_points));
  if (index.size() > limit) {
    std::stable_sort(index.begin(), index.end(), [&](std::size_t a, std::size_t b) {
      return cloud.points[a].observations > cloud.points[b].observations;
    });
    index.resize(limit);
    std::sort(index.begin(), index.end());
  }
  auto out = std::make_shared<SupportCloud>();
  out->reserve(index.size());
  for (std::size_t i : index) out->push_back(toSupport(cloud.points[i]));
  return out;
}

std::vector<float> neighbourDistances(const SupportCloud::ConstPtr& cloud, int neighbours,
                                      int threads) {
  if (cloud->empty()) return {};
  pcl::KdTreeFLANN<pcl::PointNormal> tree;
  tree.setInputCloud(cloud);
  std::vector<float> distances(cloud->size(), 0.f);
  onRanges(threads, cloud->size(), [&](std::size_t begin, std::size_t end) {
    pcl::Indices found;
    std::vector<float> squared;
    for (std::size_t i = begin; i < end; ++i) {
      // The point itself comes first, at distance zero.
      const int n = tree.nearestKSearch((*cloud)[i], neighbours + 1, found, squared);
      if (n > 0) distances[i] = std::sqrt(squared[static_cast<std::size_t>(n) - 1]);
    }
  });
  return distances;
}

float median(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

SupportCloud::Ptr freeSpaceFilter(const SupportCloud::ConstPtr& cloud, float spacing,
                                  const ReconSettings& settings) {
  const std::size_t n = cloud->size();
  const auto stride = n / static_cast<std::size_t>(settings.free_space_max_rays) + 1;
  const float margin = static_cast<float>(settings.free_space_margin) * spacing;
  const float radius = static_cast<float>(settings.free_space_radius) * spacing;
  const float squared_radius = radius * radius * static_cast<float>(stride);
  std::vector<float> x(n), y(n), z(n);  // apart, so that the compiler makes vectors of the loop
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = (*cloud)[i].x;
    y[i] = (*cloud)[i].y;
    z[i] = (*cloud)[i].z;
  }
  std::vector<int> rays(n, 0);
  onRanges(settings.threads, n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = 0; r < n; r += stride) {
      const pcl::PointNormal from = (*cloud)[r];
      for (std::size_t i = begin; i < end; ++i) {
        const float dx = x[i] - from.x, dy = y[i] - from.y, dz = z[i] - from.z;
        const float along = dx * from.normal_x + (dy * from.normal_y + dz * from.normal_z);
        const float squared = dx * dx + (dy * dy + dz * dz) - along * along;
        rays[i] += static_cast<int>(along > margin) & static_cast<int>(squared < squared_radius);
      }
    }
  });
  auto out = std::make_shared<SupportCloud>();
  out->reserve(n);
  for (std::size_t i = 0; i < n; ++i)
    if (settings.free_space_rays == 0 || rays[i] < settings.free_space_rays)
      out->push_back((*cloud)[i]);
  return out;
}

SupportCloud::Ptr radiusFilter(const SupportCloud::ConstPtr& cloud, float spacing,
                               const ReconSettings& settings) {
  auto out = std::make_shared<SupportCloud>();
  if (cloud->size() <= static_cast<std::size_t>(settings.outlier_min_neighbours)) return out;
  const std::vector<float> distances =
      neighbourDistances(cloud, settings.outlier_min_neighbours, settings.threads);
  const float radius = static_cast<float>(settings.outlier_radius) * spacing;
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i] <= radius) out->push_back((*cloud)[i]);
  return out;
}

SupportCloud::Ptr voxelGrid(const SupportCloud::ConstPtr& cloud, float spacing,
                            const ReconSettings& settings) {
  auto out = std::make_shared<SupportCloud>();
  if (cloud->empty()) return out;
  const float leaf = static_cast<float>(settings.voxel_size) * spacing;
  pcl::VoxelGrid<pcl::PointNormal> filter;
  filter.setInputCloud(cloud);
  filter.setLeafSize(leaf, leaf, leaf);
  filter.filter(*out);
  return out;
}

}  // namespace depthscope::recon
