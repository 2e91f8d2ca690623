#pragma once
#include <span>
#include <vector>

#include "types/sparse_cloud.hpp"

namespace depthscope::recon {

/// Who sees what in a cloud, both ways. Refers to the cloud, which must stay.
class CloudIndex {
 public:
  /// `sightings` point by point, in the order of the cloud's points.
  CloudIndex(const SparseCloud& cloud, std::vector<Sighting> sightings);

  const SparseCloud& cloud() const { return cloud_; }
  std::size_t views() const { return cloud_.view_frames.size(); }
  /// Points that a view sees.
  std::span<const std::uint32_t> pointsOf(std::size_t view) const {
    return {points_.data() + view_begin_[view], points_.data() + view_begin_[view + 1]};
  }
  /// The sightings of a point.
  std::span<const Sighting> sightingsOf(std::uint32_t point) const {
    return {sightings_.data() + point_begin_[point], sightings_.data() + point_begin_[point + 1]};
  }
  /// Centre of a view's camera in the world.
  const Eigen::Vector3f& centre(std::size_t view) const { return centres_[view]; }
  /// Depth of a point in a view's camera [map unit].
  float depth(std::uint32_t point, std::size_t view) const;
  /// Median depth over all sightings [map unit]; 0 without any.
  float medianDepth() const { return median_depth_; }

 private:
  void measureDepth();

  const SparseCloud& cloud_;
  std::vector<Sighting> sightings_;
  std::vector<std::size_t> view_begin_, point_begin_;
  std::vector<std::uint32_t> points_;
  std::vector<Eigen::Vector3f> centres_;
  float median_depth_ = 0;
};

}  // namespace depthscope::recon
