#pragma once
#include <vector>

#include "recon/dense/cloud_index.hpp"
#include "recon/dense/depth_map.hpp"
#include "recon/dense/rectified_picture.hpp"

namespace depthscope::recon {

/// A keyframe's picture, and its depths once they were worked out.
struct StoredKeyframe {
  std::int64_t frame = -1;  // -1: free
  RectifiedPicture picture;
  DepthMap* depth = nullptr;  // none yet
  bool retired = false;       // had a depth map, which others have made superfluous
};

/// Pictures and depth maps of keyframes in a fixed number of slots each. When the pictures are full
/// the keyframe goes that the last cloud no longer has, else the one whose points most others see,
/// too; when the depth maps are, the one whose points most other depth maps cover.
class KeyframeStore {
 public:
  KeyframeStore(int pictures, int depth_maps)
      : slots_(static_cast<std::size_t>(pictures)),
        depths_(static_cast<std::size_t>(depth_maps)),
        used_(static_cast<std::size_t>(depth_maps), false) {}

  /// A slot for the keyframe of a frame; it is free until the caller sets `frame`.
  StoredKeyframe& claim(std::int64_t frame);
  /// Learns which keyframes the map has and who sees what.
  void update(const CloudIndex& index);
  /// The slot of each keyframe of a cloud, or null.
  std::vector<StoredKeyframe*> inOrderOf(const SparseCloud& cloud);

  /// Room for the depth map of `keyframe`, taken from another if need be: `covered` counts the
  /// depth maps that see each point, and is kept up to date.
  DepthMap& makeDepth(StoredKeyframe& keyframe, const CloudIndex& index,
                      const std::vector<StoredKeyframe*>& stored, std::vector<int>& covered);

 private:
  struct Worth {
    std::int64_t frame;
    float worth;
  };
  void dropDepth(StoredKeyframe& keyframe);
  float worthOf(std::int64_t frame) const;

  std::vector<StoredKeyframe> slots_;
  std::vector<DepthMap> depths_;
  std::vector<bool> used_;
  std::vector<Worth> worth_;            // of the keyframes of the last cloud, by frame
  std::int64_t last_cloud_frame_ = -1;  // newer ones are not in it yet
};

}  // namespace depthscope::recon
