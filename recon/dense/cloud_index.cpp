#include "recon/dense/cloud_index.hpp"

#include <algorithm>

namespace depthscope::recon {

CloudIndex::CloudIndex(const SparseCloud& cloud)
    : cloud_(cloud),
      keyframe_begin_(cloud.keyframe_frames.size() + 1, 0),
      point_begin_(cloud.points.size() + 1, 0),
      points_(cloud.sightings.size()) {
  for (const Sighting& s : cloud.sightings) {
    ++keyframe_begin_[s.keyframe + 1];
    ++point_begin_[s.point + 1];
  }
  for (std::size_t i = 1; i < keyframe_begin_.size(); ++i)
    keyframe_begin_[i] += keyframe_begin_[i - 1];
  for (std::size_t i = 1; i < point_begin_.size(); ++i) point_begin_[i] += point_begin_[i - 1];
  std::vector<std::size_t> next(keyframe_begin_.begin(), keyframe_begin_.end() - 1);
  for (const Sighting& s : cloud.sightings) points_[next[s.keyframe]++] = s.point;
  for (const Pose& T_camera_world : cloud.keyframes_T_camera_world)
    centres_.push_back(T_camera_world.inverse().t.cast<float>());
}

float CloudIndex::depth(std::uint32_t point, std::size_t keyframe) const {
  const Pose& T = cloud_.keyframes_T_camera_world[keyframe];
  return static_cast<float>(T.R.row(2).dot(cloud_.points[point].position.cast<double>()) + T.t.z());
}

float CloudIndex::medianDepth() const {
  std::vector<float> depths;
  depths.reserve(cloud_.sightings.size());
  for (const Sighting& s : cloud_.sightings) depths.push_back(depth(s.point, s.keyframe));
  if (depths.empty()) return 0;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace depthscope::recon
