#pragma once
#include <functional>
#include <vector>

#include "recon/cloud_index.hpp"

namespace depthscope::recon {

/// The views to match `reference` against, `count` at most, best first: they share many points
/// with it, see them at an angle near `best_angle_deg` from about the same distance, and stand
/// apart from each other (after Goesele et al. 2007, section 4). Only those for which `usable`
/// count.
std::vector<std::size_t> selectViews(const CloudIndex& index, std::size_t reference, int count,
                                     double best_angle_deg,
                                     const std::function<bool(std::size_t)>& usable);

}  // namespace depthscope::recon
