#include "recon/cloud_index.hpp"

#include <algorithm>
#include <utility>

namespace depthscope::recon {

CloudIndex::CloudIndex(const SparseCloud& cloud, std::vector<Sighting> sightings)
    : cloud_(cloud),
      sightings_(std::move(sightings)),
      view_begin_(cloud.view_frames.size() + 1, 0),
      point_begin_(cloud.points.size() + 1, 0),
      points_(sightings_.size()) {
  for (const Sighting& s : sightings_) {
    ++view_begin_[s.view + 1];
    ++point_begin_[s.point + 1];
  }
  for (std::size_t i = 1; i < view_begin_.size(); ++i) view_begin_[i] += view_begin_[i - 1];
  for (std::size_t i = 1; i < point_begin_.size(); ++i) point_begin_[i] += point_begin_[i - 1];
  std::vector<std::size_t> next(view_begin_.begin(), view_begin_.end() - 1);
  for (const Sighting& s : sightings_) points_[next[s.view]++] = s.point;
  for (const Pose& T_camera_world : cloud.views_T_camera_world)
    centres_.push_back(T_camera_world.inverse().t.cast<float>());
  measureDepth();
}

float CloudIndex::depth(std::uint32_t point, std::size_t view) const {
  const Pose& T = cloud_.views_T_camera_world[view];
  return static_cast<float>(T.R.row(2).dot(cloud_.points[point].position.cast<double>()) + T.t.z());
}

void CloudIndex::measureDepth() {
  std::vector<float> depths;
  depths.reserve(sightings_.size());
  for (const Sighting& s : sightings_) depths.push_back(depth(s.point, s.view));
  if (depths.empty()) return;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  median_depth_ = *middle;
}

}  // namespace depthscope::recon
