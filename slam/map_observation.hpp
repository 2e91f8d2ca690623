#pragma once
#include "slam/bundle_adjuster.hpp"
#include "slam/map.hpp"

namespace depthscope::slam {

/// What bundle adjustment is told of an observation: what feature `feature` of `view` saw of a
/// point that lies at `position`, when the middle row was exposed. Of the point's trust and the
/// view's twist the caller has a copy of its own. `pose` and `point` are left to the caller.
inline BaObservation mapObservation(const RollingShutter& shutter, const Keyframe& view,
                                    int feature, const Twist& twist,
                                    const Eigen::Vector3d& position, float trust) {
  const Keypoint& k = view.features.keypoints[feature];
  BaObservation o;
  o.pixel = shutter.atMiddleRow(k, twist, view.T_camera_world * position).cast<float>();
  o.inv_sigma2 = trust / (k.sigma * k.sigma);
  return o;
}

}  // namespace depthscope::slam
