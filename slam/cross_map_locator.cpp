#include "slam/cross_map_locator.hpp"

#include <algorithm>

namespace depthscope::slam {

namespace {
constexpr std::size_t kCandidates = 8;  // a keyframe takes about 2 ms
constexpr std::size_t kMinBoth = 3;     // points of both maps to tell the scale from
}  // namespace

CrossMapLocator::CrossMapLocator(const SlamSettings& settings, const Map& map,
                                 const KeyframeDatabase& database)
    : map_(map),
      database_(database),
      relocalizer_(settings, map.intrinsics(), database),
      query_(settings),
      points_(settings.extractor.capacity()) {
  candidates_.reserve(kCandidates);
  depth_ratios_.reserve(settings.extractor.capacity());
}

std::span<const KeyframeId> CrossMapLocator::candidates(KeyframeId now) {
  candidates_.clear();
  const auto isElsewhere = [&](const PlaceMatch& place) {
    return map_.keyframe(place.keyframe).map_id != map_.keyframe(now).map_id;
  };
  const auto places = database_.find(map_, now, query_);
  if (next_ >= std::count_if(places.begin(), places.end(), isElsewhere)) next_ = 0;
  std::ptrdiff_t rank = 0;
  for (const PlaceMatch& place : places)
    if (isElsewhere(place) && rank++ >= next_ && candidates_.size() < kCandidates)
      candidates_.push_back(place.keyframe);
  next_ += kCandidates;
  return candidates_;
}

std::optional<Sim3> CrossMapLocator::locate(KeyframeId now, KeyframeId before) {
  const Keyframe& view = map_.keyframe(now);
  Pose T_now_before;
  if (!relocalizer_.relocalize(map_, map_.keyframe(before), view.features, T_now_before, points_))
    return std::nullopt;
  const auto s = scale(view, T_now_before);
  if (!s) return std::nullopt;
  Sim3 T_before_camera(T_now_before.inverse());
  T_before_camera.s = *s;
  return T_before_camera * Sim3(view.T_camera_world);
}

/// Lengths in the other map over lengths in that of `now`: the median over the depths that both
/// know.
std::optional<double> CrossMapLocator::scale(const Keyframe& now, const Pose& T_now_before) {
  depth_ratios_.clear();
  for (int f = 0; f < now.features.size(); ++f) {
    const PointId before = map_.resolve(points_[f]);
    if (before == kNone || now.points[f] == kNone) continue;
    const double depth_before = (T_now_before * map_.point(before).position).z();
    const double depth_now = (now.T_camera_world * map_.point(now.points[f]).position).z();
    if (depth_before > 0 && depth_now > 0) depth_ratios_.push_back(depth_before / depth_now);
  }
  if (depth_ratios_.size() < kMinBoth) return std::nullopt;
  const auto middle = depth_ratios_.begin() + static_cast<std::ptrdiff_t>(depth_ratios_.size() / 2);
  std::nth_element(depth_ratios_.begin(), middle, depth_ratios_.end());
  return *middle;
}

}  // namespace depthscope::slam
