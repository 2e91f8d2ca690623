#pragma once
#include <memory>
#include <stop_token>

#include "recon/recon_settings.hpp"
#include "types/sparse_cloud.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

enum class ReconStatus { Ok, TooFewPoints, Cancelled, OutOfMemory, Failed };

/// The tissue surface from a sparse cloud: radius filter, voxel grid, Moving Least Squares, Poisson,
/// trimmed to where there were observations (Chen et al. 2017, section 3). Deterministic: one cloud, one mesh.
class Reconstructor {
 public:
  explicit Reconstructor(const ReconSettings& settings);
  ~Reconstructor();
  /// Fills `out` (world frame of the cloud; normals towards the cameras). On any status but Ok `out` is left
  /// as it was. Does not throw. Stops within about a stage's time when `stop` is requested.
  ReconStatus reconstruct(const SparseCloud& cloud, SurfaceMesh& out, std::stop_token stop = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace depthscope::recon
