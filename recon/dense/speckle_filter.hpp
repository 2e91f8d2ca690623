#pragma once
#include "recon/dense/depth_map.hpp"

namespace depthscope::recon {

/// Forgets the depths of small patches that no step below `tolerance` [1 / map unit] connects to
/// what is around them: wrong matches come in patches.
void removeSpeckles(DepthMap& map, float tolerance);

}  // namespace depthscope::recon
