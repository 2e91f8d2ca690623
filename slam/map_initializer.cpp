#include "slam/map_initializer.hpp"

namespace depthscope::slam {

namespace {

TwoViewSettings twoViewSettings(const InitializerSettings& s) {
  TwoViewSettings t;
  t.sigma_px = s.sigma_px;
  t.max_depth_sigma = s.max_depth_sigma / s.initial_parallax;
  t.min_inliers = s.min_points;
  return t;
}

}  // namespace

MapInitializer::MapInitializer(const SlamSettings& settings, const CameraModel& camera)
    : settings_(settings.initializer),
      matcher_(settings.matching, settings.extractor.features),
      two_view_(twoViewSettings(settings.initializer), {camera.fx, camera.fy, camera.cx, camera.cy},
                settings.extractor.features),
      reference_(settings.extractor.features, camera) {
  matches_.resize(settings.extractor.features);
  matched_.reserve(settings.extractor.features);
  first_.reserve(settings.extractor.features);
  second_.reserve(settings.extractor.features);
  result_.points.reserve(settings.extractor.features);
  result_.triangulated.reserve(settings.extractor.features);
}

void MapInitializer::setReference(const FeatureSet& features, std::int64_t frame,
                                  double timestamp_s) {
  has_reference_ = features.size() >= settings_.min_matches;
  reference_ = features;
  reference_frame_ = frame;
  reference_timestamp_s_ = timestamp_s;
}

bool MapInitializer::offer(const FeatureSet& features, std::int64_t frame, double timestamp_s,
                           Map& map) {
  if (!has_reference_) {
    setReference(features, frame, timestamp_s);
    return false;
  }
  // Noise drowns the finest corners first: where they find too few of each other, coarser ones may.
  int finest = 0;
  if (match(features, finest) < settings_.min_matches &&
      match(features, finest = Matcher::kInitialLevels) < settings_.min_matches) {
    setReference(features, frame, timestamp_s);
    return false;
  }
  matched_.clear();
  first_.clear();
  second_.clear();
  for (int i = 0; i < reference_.size(); ++i) {
    if (matches_[i] < 0) continue;
    const Keypoint& a = reference_.keypoints[i];
    const Keypoint& b = features.keypoints[matches_[i]];
    matched_.push_back(i);
    first_.push_back({a.ux, a.uy});
    second_.push_back({b.ux, b.uy});
  }
  if (!two_view_.reconstruct(first_, second_, result_, map.scaleOf(finest))) return false;
  return buildMap(features, frame, timestamp_s, map);
}

int MapInitializer::match(const FeatureSet& features, int finest) {
  return matcher_.matchForInitialization(reference_, features, settings_.search_radius_px, matches_,
                                         finest);
}

bool MapInitializer::buildMap(const FeatureSet& features, std::int64_t frame, double timestamp_s,
                              Map& map) {
  map.start();
  const KeyframeId first =
      map.addKeyframe(reference_, Pose{}, reference_frame_, reference_timestamp_s_);
  const KeyframeId second = map.addKeyframe(features, result_.T_second_first, frame, timestamp_s);
  for (std::size_t m = 0; m < matched_.size(); ++m) {
    if (!result_.triangulated[m]) continue;
    const PointId p = map.addPoint(result_.points[m], map.keyframe(second).serial);
    if (p == kNone) break;
    map.observe(p, first, matched_[m]);
    map.observe(p, second, matches_[matched_[m]]);
    map.refreshPoint(p);
  }
  map.rescale(1 / map.medianDepth(first));
  has_reference_ = false;
  return true;
}

}  // namespace depthscope::slam
