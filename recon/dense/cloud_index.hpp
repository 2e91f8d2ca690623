#pragma once
#include <span>
#include <vector>

#include "types/sparse_cloud.hpp"

namespace depthscope::recon {

/// Who sees what in a cloud, both ways. Refers to the cloud, which must stay.
class CloudIndex {
 public:
  explicit CloudIndex(const SparseCloud& cloud);

  const SparseCloud& cloud() const { return cloud_; }
  std::size_t keyframes() const { return cloud_.keyframe_frames.size(); }
  /// Points that a keyframe sees.
  std::span<const std::uint32_t> pointsOf(std::size_t keyframe) const {
    return {points_.data() + keyframe_begin_[keyframe],
            points_.data() + keyframe_begin_[keyframe + 1]};
  }
  /// The sightings of a point.
  std::span<const Sighting> sightingsOf(std::uint32_t point) const {
    return {cloud_.sightings.data() + point_begin_[point],
            cloud_.sightings.data() + point_begin_[point + 1]};
  }
  /// Centre of a keyframe's camera in the world.
  const Eigen::Vector3f& centre(std::size_t keyframe) const { return centres_[keyframe]; }
  /// Depth of a point in a keyframe's camera [map unit].
  float depth(std::uint32_t point, std::size_t keyframe) const;
  /// Median depth over all sightings [map unit]; 0 without any.
  float medianDepth() const;

 private:
  const SparseCloud& cloud_;
  std::vector<std::size_t> keyframe_begin_, point_begin_;
  std::vector<std::uint32_t> points_;
  std::vector<Eigen::Vector3f> centres_;
};

}  // namespace depthscope::recon
