#include "platform/ar/surface_log.hpp"

#include "platform/log.hpp"

namespace depthscope::platform {

void logReconstruction(recon::ReconStatus status, std::size_t points,
                       const recon::SurfaceChange& change) {
  if (status == recon::ReconStatus::OutOfMemory || status == recon::ReconStatus::Failed)
    log(LogPriority::Warning, "reconstruction failed",
        {{"why", recon::toString(status)}, {"points", points}});
  if (status == recon::ReconStatus::Ok && change.share_beyond > 0)
    log(LogPriority::Notice, "surface jumps",
        {{"places_percent", 100 * change.share_beyond},
         {"largest_percent_of_depth", 100 * change.largest}});
}

}  // namespace depthscope::platform
