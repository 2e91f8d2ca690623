#pragma once
#include <cstddef>

#include "recon/recon_status.hpp"
#include "recon/surface_change.hpp"

namespace depthscope::platform {

/// Says in the log what went wrong with a reconstruction of so many points, and where its surface
/// jumps from the one that it replaces (Reconstructor::lastChange()): nothing else.
void logReconstruction(recon::ReconStatus status, std::size_t points,
                       const recon::SurfaceChange& change);

}  // namespace depthscope::platform
