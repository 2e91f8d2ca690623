#include "recon/mls_smoothing.hpp"

#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "recon/point_filters.hpp"
#include "recon/threads.hpp"

namespace depthscope::recon {
namespace {

struct Projection {
  SupportCloud points;  // on the fitted surface, normals not yet oriented
  pcl::Indices source;  // index of each into the input
};

/// Of the points `begin` to `end` - 1.
Projection projectRange(const SupportCloud::ConstPtr& cloud, std::size_t begin, std::size_t end,
                        float spacing, const ReconSettings& settings) {
  const auto range = std::make_shared<pcl::Indices>(end - begin);
  std::iota(range->begin(), range->end(), static_cast<pcl::index_t>(begin));
  pcl::MovingLeastSquares<pcl::PointNormal, pcl::PointNormal> mls;
  mls.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointNormal>>(/*sorted=*/false));
  mls.setInputCloud(cloud);
  mls.setIndices(range);
  mls.setSearchRadius(settings.mls_radius * spacing);  // PCL takes the Gaussian's width from it too
  mls.setPolynomialOrder(2);
  mls.setComputeNormals(true);
  Projection out;
  mls.process(out.points);
  out.source = mls.getCorrespondingIndices()->indices;
  return out;
}

Projection project(const SupportCloud::ConstPtr& cloud, float spacing,
                   const ReconSettings& settings) {
  std::vector<Projection> parts(static_cast<std::size_t>(settings.threads));
  onThreads(settings.threads, [&](int thread) {
    const auto i = static_cast<std::size_t>(thread);
    parts[i] = projectRange(cloud, cloud->size() * i / parts.size(),
                            cloud->size() * (i + 1) / parts.size(), spacing, settings);
  });
  Projection all = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    all.points += parts[i].points;
    all.source.insert(all.source.end(), parts[i].source.begin(), parts[i].source.end());
  }
  return all;
}

/// Input points that lie within the scatter of the tissue around its fitted surface.
SupportCloud::Ptr withoutOutliers(const SupportCloud& cloud, const Projection& fit,
                                  const ReconSettings& settings) {
  std::vector<float> residual(fit.source.size());
  for (std::size_t i = 0; i < residual.size(); ++i)
    residual[i] = (fit.points[i].getVector3fMap() -
                   cloud[static_cast<std::size_t>(fit.source[i])].getVector3fMap())
                      .norm();
  // 1.4826: the standard deviation of a normal distribution over its median absolute deviation.
  const float limit = static_cast<float>(settings.mls_max_residual) * 1.4826f * median(residual);
  auto kept = std::make_shared<SupportCloud>();
  kept->reserve(residual.size());
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (residual[i] <= limit) kept->push_back(cloud[static_cast<std::size_t>(fit.source[i])]);
  return kept;
}

}  // namespace

SupportCloud::Ptr mlsSmooth(const SupportCloud::ConstPtr& cloud, float spacing,
                            const ReconSettings& settings) {
  auto out = std::make_shared<SupportCloud>();
  if (cloud->empty()) return out;
  const SupportCloud::ConstPtr inliers =
      withoutOutliers(*cloud, project(cloud, spacing, settings), settings);
  if (inliers->empty()) return out;
  const Projection fit = project(inliers, spacing, settings);
  const auto min_cosine =
      static_cast<float>(std::cos(settings.max_view_tilt_deg * std::numbers::pi / 180));
  out->reserve(fit.points.size());
  for (std::size_t i = 0; i < fit.points.size(); ++i) {
    pcl::PointNormal p = fit.points[i];
    const pcl::PointNormal& seen = (*inliers)[static_cast<std::size_t>(fit.source[i])];
    const float cosine = p.getNormalVector3fMap().dot(seen.getNormalVector3fMap());
    // Also turns away what is not a number.
    if (!(std::abs(cosine) >= min_cosine) || !p.getVector3fMap().allFinite()) continue;
    if (cosine < 0) p.getNormalVector3fMap() *= -1.f;
    p.getNormalVector3fMap().normalize();
    p.curvature = seen.curvature;
    out->push_back(p);
  }
  return out;
}

}  // namespace depthscope::recon
