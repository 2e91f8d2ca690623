#pragma once
#include <array>
#include <stop_token>

#include "recon/dense/depth_estimator.hpp"
#include "recon/dense/tsdf_volume.hpp"
#include "recon/dense/view_store.hpp"
#include "recon/recon_status.hpp"
#include "recon/view_picture.hpp"
#include "types/surface_mesh.hpp"

namespace depthscope::recon {

/// The tissue surface from the pictures of views: depth maps by multi-view stereo, each worked
/// out once and kept, those that confirm each other fused into a volume of signed distances, whose
/// zero level is the surface. Poses and the unit of length are those of the cloud at hand, so depth
/// maps follow the map's corrections. Time and memory are bounded by the settings: depth maps made
/// for a surface, depth maps kept, blocks of the volume.
class DenseReconstructor {
 public:
  /// The work is shared by `threads`; the surface does not depend on how many.
  DenseReconstructor(const CameraModel& camera, const DenseSettings& settings, int threads);

  /// Keeps a view's picture, reduced by reductionFactor(camera width, picture_width).
  void addPicture(const ViewPicture& picture);
  /// Fills vertices, normals, confidence, observations and triangles of `mesh` (at most
  /// `max_triangles`). `mesh` is of no use on any status but Ok.
  ReconStatus reconstruct(const CloudIndex& index, int max_triangles, SurfaceMesh& mesh,
                          const std::stop_token& stop);

 private:
  static constexpr int kAtOnce = 2;  // depth maps chosen together, and worked out side by side

  ReconStatus makeDepthMaps(const CloudIndex& index, const std::stop_token& stop);
  std::array<bool, kAtOnce> estimateDepths(const CloudIndex& index,
                                           const std::vector<std::size_t>& views, float max_error,
                                           const std::stop_token& stop);
  bool estimateDepth(const CloudIndex& index, std::size_t view, DepthEstimator& estimator,
                     float max_error, DepthMap& out, const std::stop_token& stop) const;
  std::vector<FusedView> placeDepthMaps(const CloudIndex& index) const;
  float inverseScale(const CloudIndex& index, std::size_t view) const;
  ReconStatus fuse(const std::vector<FusedView>& views, float voxel_size,
                   const std::stop_token& stop);

  DenseSettings settings_;
  int threads_;
  PinholeView view_;
  std::vector<DepthEstimator> estimators_;   // of each thread
  std::array<DepthMap, kAtOnce> estimates_;  // on their way into the store
  ViewStore store_;
  std::vector<StoredView*> stored_;  // of each view of the cloud at hand
  TsdfVolume volume_;
  std::vector<TsdfVolume::ViewPixels> scratch_;  // of each thread
};

}  // namespace depthscope::recon
