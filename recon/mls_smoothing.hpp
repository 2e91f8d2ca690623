#pragma once
#include "recon/recon_settings.hpp"
#include "recon/support_cloud.hpp"

namespace depthscope::recon {

/// Moving Least Squares (paper, section 3.2; Alexa et al. 2003): each point is projected onto a
/// second-order polynomial fitted to its neighbourhood with a Gaussian weight, and gets the normal
/// of that polynomial, turned towards the cameras that saw it. `cloud` holds directions to the
/// cameras in its normals. Points far from the fit (`mls_max_residual`) or seen at a grazing angle
/// (`max_view_tilt_deg`) are left out.
SupportCloud::Ptr mlsSmooth(const SupportCloud::ConstPtr& cloud, float spacing,
                            const ReconSettings& settings);

}  // namespace depthscope::recon
