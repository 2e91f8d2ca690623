#pragma once
#include <cstdint>
#include <stop_token>

#include "recon/recon_settings.hpp"
#include "types/sparse_cloud.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

enum class ReconStatus { Ok, TooFewPoints, Cancelled, OutOfMemory, Failed };

/// The status in words, for logs.
const char* toString(ReconStatus status);

/// The tissue surface from a sparse cloud: radius filter, voxel grid, Moving Least Squares,
/// Poisson, trimmed to where there were observations (Chen et al. 2017, section 3). Deterministic:
/// one cloud, one mesh.
class Reconstructor {
 public:
  /// Throws InputError where a setting is out of its range.
  explicit Reconstructor(const ReconSettings& settings);
  /// Fills `out` (world frame of the cloud; normals towards the cameras). On any status but Ok
  /// `out` is left as it was. Does not throw. Stops within about a stage's time when `stop` is
  /// requested.
  ReconStatus reconstruct(const SparseCloud& cloud, SurfaceMesh& out,
                          std::stop_token stop = {}) noexcept;

 private:
  ReconStatus run(const SparseCloud& cloud, SurfaceMesh& mesh, const std::stop_token& stop) const;

  ReconSettings settings_;
  std::uint32_t version_ = 0;  // of the last surface made
};

}  // namespace depthscope::recon
