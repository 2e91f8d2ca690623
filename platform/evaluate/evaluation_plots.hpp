#pragma once
#include <filesystem>

#include "platform/evaluate/evaluation.hpp"

namespace depthscope::platform {

/// Draws into `folder`, made if missing: trajectory_3d.png, trajectory_axes.png (aligned estimate
/// and truth along each axis, and their distance, over time) and, with a surface,
/// surface_distance.png (signed distance to the truth on the surface, seen from the mean camera)
/// and surface_histogram.png. Throws InputError when the folder cannot be written.
void drawPlots(const Evaluation& evaluation, const std::filesystem::path& folder);

}  // namespace depthscope::platform
