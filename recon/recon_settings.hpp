#pragma once

namespace depthscope::recon {

/// Settings of the paper's reconstruction (Chen et al. 2017, section 3). Monocular maps have no unit of
/// length, so every length is given as a multiple of `spacing`: the median distance between neighbouring
/// points of the cloud at hand.
struct ReconSettings {
  double period_s = 3.0;             // a new surface this often; 0: only on demand
  int min_points = 100;              // fewer: no surface is attempted
};

}  // namespace depthscope::recon
