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

MapInitializer::MapInitializer(const SlamSettings& settings, const CameraModel& camera,
                               const OrbExtractor& extractor)
    : settings_(settings.initializer),
      matcher_(settings.matching, settings.extractor.capacity()),
      two_view_(twoViewSettings(settings.initializer), {camera.fx, camera.fy, camera.cx, camera.cy},
                settings.extractor.capacity()),
      reference_(settings.extractor.capacity(), camera),
      extractor_(extractor),
      follower_(extractor, settings.extractor.capacity()),
      spare_(settings.extractor.capacity()) {
  matches_.resize(settings.extractor.capacity());
  matched_.reserve(settings.extractor.capacity());
  first_.reserve(settings.extractor.capacity());
  second_.reserve(settings.extractor.capacity());
  result_.points.reserve(settings.extractor.capacity());
  result_.triangulated.reserve(settings.extractor.capacity());
}

void MapInitializer::setReference(const FeatureSet& features, std::int64_t frame,
                                  double timestamp_s) {
  has_reference_ = features.size() >= settings_.min_matches;
  reference_ = features;
  follower_.begin(features, Matcher::kInitialLevels);
  following_ = false;
  reference_frame_ = frame;
  reference_timestamp_s_ = timestamp_s;
}

bool MapInitializer::offer(FeatureSet& features, std::int64_t frame, double timestamp_s, Map& map) {
  if (!has_reference_ || !findAgain(features)) {
    setReference(features, frame, timestamp_s);
    return false;
  }
  if (!two_view_.reconstruct(first_, second_, result_, map.scaleOf(finest_))) return false;
  if (following_) makeFeatures(features);
  return buildMap(features, frame, timestamp_s, map);
}

/// Pairs of the reference's features and where they are now; false when they are too few.
bool MapInitializer::findAgain(const FeatureSet& features) {
  matched_.clear();
  first_.clear();
  second_.clear();
  // Noise drowns the finest corners first: where they find too few of each other, coarser ones may,
  // and where those do not their surroundings may still be followed. With noise of 10 grey levels a
  // map was begun in the middle of the sample before, 63 % of it tracked; now from the first
  // pictures on (99 %; in a third of the light 94 % instead of 64).
  finest_ = following_ ? Matcher::kInitialLevels : 0;
  if (!following_)
    following_ = match(features, finest_) < settings_.min_matches &&
                 match(features, finest_ = Matcher::kInitialLevels) < settings_.min_matches;
  if (!following_) {
    pairMatched(features);
    return true;
  }
  if (follower_.follow() < settings_.min_matches) return false;
  pairFollowed();
  return true;
}

void MapInitializer::pairMatched(const FeatureSet& features) {
  for (int i = 0; i < reference_.size(); ++i) {
    if (matches_[i] < 0) continue;
    const Keypoint& a = reference_.keypoints[i];
    const Keypoint& b = features.keypoints[matches_[i]];
    matched_.push_back(i);
    first_.push_back({a.ux, a.uy});
    second_.push_back({b.ux, b.uy});
  }
}

void MapInitializer::pairFollowed() {
  for (const FeatureFollower::Followed& f : follower_.followed()) {
    const Keypoint& a = reference_.keypoints[f.feature];
    matched_.push_back(f.feature);
    first_.push_back({a.ux, a.uy});
    second_.push_back(f.pixel.cast<float>());
  }
}

/// Of what was followed and has a point, features of the view that it was followed to.
void MapInitializer::makeFeatures(FeatureSet& features) {
  spare_.collect(features, [](int) { return true; });
  const auto followed = follower_.followed();
  for (std::size_t m = 0; m < matched_.size(); ++m) {
    const int f = matched_[m];
    const auto slot = spare_.slot(features);
    result_.triangulated[m] =
        result_.triangulated[m] && slot &&
        extractor_.describe(followed[m].place, reference_.keypoints[f].octave, features, *slot);
    if (!result_.triangulated[m]) continue;
    spare_.take(*slot);
    matches_[f] = *slot;
  }
  features.grid.build(features.keypoints);
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
