#pragma once
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <memory>

namespace depthscope::recon {

/// Points on their way to a surface. `normal` is the unit direction to the cameras until Moving
/// Least Squares replaces it by the surface normal; `curvature` carries the number of keyframes
/// that saw the point, so that PCL's filters average it along.
using SupportCloud = pcl::PointCloud<pcl::PointNormal>;

}  // namespace depthscope::recon
