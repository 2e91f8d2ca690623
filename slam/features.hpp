#pragma once
#include <vector>

#include "slam/descriptor.hpp"
#include "slam/feature_grid.hpp"
#include "slam/keypoint.hpp"
#include "types/camera_model.hpp"

namespace depthscope::slam {

/// What the extractor finds in one picture. Arrays are parallel; their capacity is fixed at
/// construction.
struct FeatureSet {
  FeatureSet() = default;
  /// Room for `capacity` features (ExtractorSettings::capacity()) of pictures of `camera`.
  FeatureSet(int capacity, const CameraModel& camera) : grid(capacity, camera) {
    keypoints.reserve(capacity);
    descriptors.reserve(capacity);
  }
  /// Writes to all of its memory, so that a picture need not wait for the system to find it. Empty
  /// afterwards.
  void touch() {
    keypoints.resize(keypoints.capacity());
    descriptors.resize(descriptors.capacity());
    keypoints.clear();
    descriptors.clear();
  }
  int size() const { return static_cast<int>(keypoints.size()); }

  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;  // of keypoints[i]
  FeatureGrid grid;                     // over (ux, uy) of keypoints
};

}  // namespace depthscope::slam
