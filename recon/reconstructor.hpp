#pragma once
#include <cstdint>
#include <memory>
#include <stop_token>

#include "recon/pinhole_view.hpp"
#include "recon/recon_settings.hpp"
#include "recon/recon_status.hpp"
#include "recon/surface_change.hpp"
#include "types/camera_model.hpp"
#include "types/memory_meter.hpp"
#include "types/sparse_cloud.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

class DenseReconstructor;
class SurfacePainter;
struct ViewPicture;

/// The tissue surface, by the method of the settings. Sparse: from the map points alone; radius
/// filter, voxel grid, Moving Least Squares, Poisson, trimmed to where there were observations
/// (Chen et al. 2017, section 3). Dense: from the views' pictures, see DenseReconstructor; from
/// the map points for as long as too few pictures confirm one another. Deterministic: the same
/// pictures and clouds in the same order give the same meshes.
class Reconstructor {
 public:
  /// Throws InputError where a setting is out of its range.
  Reconstructor(const CameraModel& camera, const ReconSettings& settings);
  ~Reconstructor();

  /// Keeps a view's picture for the surfaces to come: its colour, and its luma where the method
  /// needs it, reduced by pictureReduction(). Does not throw.
  void addPicture(const ViewPicture& picture) noexcept;
  /// The factor by which luma is to be reduced; 0: none is needed.
  int pictureReduction() const { return reduction_; }

  /// Fills `out` (world frame of the cloud; normals towards the cameras; colours as far as there
  /// are pictures). On any status but Ok `out` is left as it was. Does not throw. Stops within
  /// about a stage's time when `stop` is requested.
  ReconStatus reconstruct(const SparseCloud& cloud, SurfaceMesh& out,
                          std::stop_token stop = {}) noexcept;

  /// A place that moves by more than this share of the median depth from one surface to the next
  /// jumps: 2 mm at a working distance of 100 mm.
  static constexpr float kJump = 0.02f;
  /// How the last surface differs from the one before it, in shares of the median depth; nothing
  /// where that one was of another map. `share_beyond` is of kJump.
  const SurfaceChange& lastChange() const { return change_; }
  /// What all of reconstruction holds in memory, PCL included, and ever held at most.
  const MemoryMeter& memory() const { return memory_; }

 private:
  /// `depth`: the median of the map points [map unit].
  void compareWithLast(const SurfaceMesh& mesh, float depth);
  ReconStatus sparse(const SparseCloud& cloud, SurfaceMesh& mesh,
                     const std::stop_token& stop) const;

  MemoryMeter memory_;  // before what is metered
  ReconSettings settings_;
  PinholeLevel seen_;  // what a picture shows
  int reduction_ = 0;
  std::unique_ptr<DenseReconstructor> dense_;  // null for the sparse method
  std::unique_ptr<SurfacePainter> painter_;
  std::uint32_t version_ = 0;  // of the last surface made
  SurfaceMesh last_;           // its vertices
  SurfaceChange change_;
};

}  // namespace depthscope::recon
