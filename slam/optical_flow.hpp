#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>

#include "slam/image_buffer.hpp"

namespace depthscope::slam {

/// A picture at falling resolutions, all levels smoothed alike; pixel (x, y) of level l shows
/// ((x, y) + 1/2) * scale(l) - 1/2 of level 0.
struct SmoothedPyramid {
  std::span<const ImageBuffer> levels;
  std::span<const float> scales;
};

/// Where the patch around `from` in `first` has gone in `second` [px of level 0, captured]: Lucas
/// and Kanade's method, inverse compositional (Baker & Matthews 2004), from the coarsest level down
/// to `octave`, whose pixels the patch is 16 x 16 of. Gain and offset of the grey levels are free,
/// for the light travels with the scope (as in SD-DefSLAM, Gomez-Rodriguez et al. 2021, section
/// III.A). Nothing where the patch has no texture in both directions, leaves the picture, or has
/// become another one (normalized cross-correlation). Does not allocate.
std::optional<Eigen::Vector2d> followPatch(const SmoothedPyramid& first,
                                           const SmoothedPyramid& second,
                                           const Eigen::Vector2d& from, int octave,
                                           const Eigen::Vector2d& guess);

}  // namespace depthscope::slam
