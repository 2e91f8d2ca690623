#pragma once
#include <vector>

#include "recon/cloud_index.hpp"
#include "recon/dense/depth_map.hpp"
#include "recon/dense/rectified_picture.hpp"

namespace depthscope::recon {

/// A view's picture, and its depths once they were worked out.
struct StoredView {
  std::int64_t frame = -1;  // -1: free
  RectifiedPicture picture;
  DepthMap* depth = nullptr;  // none yet
};

/// Pictures and depth maps of views in a fixed number of slots each. When the pictures are full
/// the view goes that the last cloud no longer has, else the one whose points most others see,
/// too; when the depth maps are, the one that has another one nearest to it.
class ViewStore {
 public:
  ViewStore(int pictures, int depth_maps)
      : slots_(static_cast<std::size_t>(pictures)),
        depths_(static_cast<std::size_t>(depth_maps)),
        used_(static_cast<std::size_t>(depth_maps), false) {}

  /// A slot for the view of a frame; it is free until the caller sets `frame`.
  StoredView& claim(std::int64_t frame);
  /// Learns which views the map has and who sees what.
  void update(const CloudIndex& index);
  /// The slot of each view of a cloud, or null.
  std::vector<StoredView*> inOrderOf(const SparseCloud& cloud);

  /// How far (motionBetween) a view must be from all that have a depth map to be worth one: 0 while
  /// there is room.
  double worthFrom(const std::vector<StoredView*>& stored, const std::vector<Pose>& T_camera_world,
                   double depth);
  /// Room for the depth map of `view`; if need be it is taken from the view that has another
  /// one nearest to it. `stored` and the poses are those of a cloud, `depth` its median [map unit].
  DepthMap& makeDepth(StoredView& view, const std::vector<StoredView*>& stored,
                      const std::vector<Pose>& T_camera_world, double depth);

 private:
  struct Worth {
    std::int64_t frame;
    float worth;
  };
  struct Redundant {
    StoredView* view;
    double motion;  // to the nearest other one; 0 where it is of no use any more
  };
  Redundant mostRedundant(const std::vector<StoredView*>& stored,
                          const std::vector<Pose>& T_camera_world, double depth);
  void dropDepth(StoredView& view);
  float worthOf(std::int64_t frame) const;

  std::vector<StoredView> slots_;
  std::vector<DepthMap> depths_;
  std::vector<bool> used_;
  std::vector<Worth> worth_;            // of the views of the last cloud, by frame
  std::int64_t last_cloud_frame_ = -1;  // newer ones are not in it yet
};

}  // namespace depthscope::recon
