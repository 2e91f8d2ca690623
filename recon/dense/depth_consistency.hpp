#pragma once
#include <span>
#include <vector>

#include "recon/dense/dense_settings.hpp"
#include "recon/dense/depth_map.hpp"

namespace depthscope::recon {

/// A depth map in its place.
struct FusedView {
  const DepthMap* map = nullptr;
  Pose T_camera_world;
  float inverse_scale = 1;  // times the map's inverse depths: its view's unit of length now
  std::vector<std::size_t> neighbours;  // other fused views of about the same place
  Grid<std::uint8_t> agreeing;  // of these, at each pixel; 0 also where others see through it
};

/// Counts for each depth of `views[i]` the neighbours that agree with it (Merrell et al. 2007).
/// A neighbour that sees past the place speaks against one that agrees.
void countAgreement(std::vector<FusedView>& views, std::size_t i, const PinholeLevel& level,
                    const DenseSettings& settings);

}  // namespace depthscope::recon
