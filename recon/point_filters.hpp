#pragma once
#include <Eigen/Core>
#include <vector>

#include "recon/recon_settings.hpp"
#include "recon/support_cloud.hpp"
#include "types/sparse_cloud.hpp"

namespace depthscope::recon {

/// The points worth looking at: finite, seen by enough keyframes, reprojected well, not immensely
/// far away; the `max_points` most observed ones where there are more, in the order of the cloud.
SupportCloud::Ptr usablePoints(const SparseCloud& cloud, const ReconSettings& settings);

/// Distance of each point to its `neighbours`-th neighbour [map units], to the farthest other one
/// where there are too few.
std::vector<float> neighbourDistances(const SupportCloud::ConstPtr& cloud, int neighbours,
                                      int threads);

/// Median of `values`; 0 for none.
float median(std::vector<float> values);

/// Drops points that stand between `free_space_rays` others and their cameras: those could not have
/// been seen through it. Bounded by points x `free_space_max_rays`.
SupportCloud::Ptr freeSpaceFilter(const SupportCloud::ConstPtr& cloud, float spacing,
                                  const ReconSettings& settings);

/// Keeps points with at least `outlier_min_neighbours` others within `outlier_radius` (paper,
/// section 3.1).
SupportCloud::Ptr radiusFilter(const SupportCloud::ConstPtr& cloud, float spacing,
                               const ReconSettings& settings);

/// One mean point for each occupied voxel of `voxel_size` (paper, section 3.1).
SupportCloud::Ptr voxelGrid(const SupportCloud::ConstPtr& cloud, float spacing,
                            const ReconSettings& settings);

}  // namespace depthscope::recon
