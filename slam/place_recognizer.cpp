#include "slam/place_recognizer.hpp"

#include <algorithm>

namespace depthscope::slam {

namespace {

constexpr int kCandidates = 5;        // keyframes examined as the place of a new one
constexpr double kLeastShare = 0.75;  // of the similarity with the least similar neighbour
constexpr int kMinMatches = 20;       // of points, by descriptor
constexpr int kMaxHamming = 80;       // of these; as in relocalization the consensus has to tell
constexpr int kWindowNeighbours = 8;  // keyframes around the one before
constexpr double kWideRadius_px = 8, kNarrowRadius_px = 4;  // at level 0, around projected points
// Pairs of points that agree after the guided search. Of wrong similarities none had any; of right
// ones, between maps of one place from views 20 degrees apart, some had no more than this.
constexpr int kMinRefined = 15;
constexpr int kMinFound = 50;                     // points of the window found in the new keyframe
constexpr int kWitnesses = 5, kMinWitnesses = 2;  // keyframes around that are asked, and must agree
constexpr double kWitnessShare = 0.6;             // of those asked must agree
constexpr int kMinFoundByWitness = 25;
constexpr double kAgreement = 0.03;  // of the distance to the points: two similarities are the same

}  // namespace

PlaceRecognizer::PlaceRecognizer(const SlamSettings& settings, const Map& map,
                                 const KeyframeDatabase& database)
    : map_(map),
      database_(database),
      matcher_(settings.matching, settings.extractor.capacity()),
      locator_(settings, map, database),
      query_(settings),
      score_query_(settings) {
  const std::size_t features = settings.extractor.capacity();
  const std::size_t keyframes = settings.capacity.keyframes;
  const std::size_t points = settings.capacity.local_points;
  shared_.resize(keyframes);
  votes_.resize(keyframes);
  neighbours_.reserve(keyframes);
  nearest_now_.resize(features);
  nearest_before_.resize(features);
  matches_.resize(features);
  sim3_matches_.reserve(features);
  window_.reserve(kWindowNeighbours + 1);
  window_points_.reserve(points);
  stamp_.resize(settings.capacity.map_points, 0);
  projected_.reserve(points);
  pairs_.reserve(features);
}

std::optional<PlaceLink> PlaceRecognizer::recognize(KeyframeId keyframe) {
  const double least = kLeastShare * leastSimilarityAround(keyframe);
  if (neighbours_.size() < kMinWitnesses) return std::nullopt;
  int examined = 0;
  for (const PlaceMatch& place : database_.find(map_, keyframe, query_)) {
    if (place.score < least || examined == kCandidates) break;
    if (isConnected(place.keyframe)) continue;
    ++examined;
    if (const auto link = examine(keyframe, place.keyframe)) return link;
  }
  return locateElsewhere(keyframe);
}

double PlaceRecognizer::leastSimilarityAround(KeyframeId keyframe) {
  map_.countShared(keyframe, shared_);
  neighbours_.clear();
  double least = 1;
  for (KeyframeId k = 0; k < map_.keyframeCapacity(); ++k) {
    if (!isConnected(k)) continue;
    neighbours_.push_back(k);
    least = std::min(least, database_.score(keyframe, k, score_query_));
  }
  std::sort(neighbours_.begin(), neighbours_.end(), [&](KeyframeId a, KeyframeId b) {
    return shared_[a] != shared_[b] ? shared_[a] > shared_[b]
                                    : map_.keyframe(a).serial > map_.keyframe(b).serial;
  });
  return least;
}

std::optional<PlaceLink> PlaceRecognizer::examine(KeyframeId now, KeyframeId before) {
  matchPoints(now, before);
  if (static_cast<int>(sim3_matches_.size()) < kMinMatches) return std::nullopt;
  PlaceLink link{now, before, {}, 0};
  if (solveSim3(map_.intrinsics(), sim3_matches_, {}, link.T_before_now) == 0) return std::nullopt;
  return verify(link);
}

std::optional<PlaceLink> PlaceRecognizer::locateElsewhere(KeyframeId now) {
  for (const KeyframeId before : locator_.candidates(now))
    if (const auto T_before_now = locator_.locate(now, before))
      if (const auto link = verify({now, before, *T_before_now, 0})) return link;
  return std::nullopt;
}

std::optional<PlaceLink> PlaceRecognizer::verify(PlaceLink link) {
  const KeyframeId now = link.now;
  collectWindow(link.before);
  if (refineInWindow(link, kWideRadius_px, link.T_before_now) < kMinRefined) return std::nullopt;
  if (refineInWindow(link, kNarrowRadius_px, link.T_before_now) < kMinRefined) return std::nullopt;
  link.matches =
      matchWindow(now, link.T_before_now, kNarrowRadius_px, matcher_.settings().hamming_loose);
  if (link.matches < kMinFound) return std::nullopt;
  pairs_.clear();
  for (int f = 0; f < map_.keyframe(now).features.size(); ++f)
    if (matches_[f] >= 0 && map_.keyframe(now).points[f] != kNone)
      pairs_.push_back({projected_[matches_[f]].source, map_.keyframe(now).points[f]});

  if (witnessesAgree(link.T_before_now) || agreesWithLast(link)) {
    unconfirmed_.reset();
    return link;
  }
  unconfirmed_ = link;
  return std::nullopt;
}

/// Points of `before` with those of `now` whose descriptors are nearest to each other both ways.
void PlaceRecognizer::matchPoints(KeyframeId now, KeyframeId before) {
  const Keyframe& a = map_.keyframe(before);
  const Keyframe& b = map_.keyframe(now);
  std::fill(nearest_before_.begin(), nearest_before_.end(), Nearest{});
  for (int i = 0; i < a.features.size(); ++i) {
    nearest_now_[i] = {};
    if (a.points[i] == kNone) continue;
    for (int j = 0; j < b.features.size(); ++j) {
      if (b.points[j] == kNone) continue;
      const int d = hammingDistance(a.features.descriptors[i], b.features.descriptors[j]);
      if (d < nearest_now_[i].distance) nearest_now_[i] = {j, d};
      if (d < nearest_before_[j].distance) nearest_before_[j] = {i, d};
    }
  }
  sim3_matches_.clear();
  for (int i = 0; i < a.features.size(); ++i)
    if (const Nearest& n = nearest_now_[i];
        n.distance <= kMaxHamming && nearest_before_[n.feature].feature == i)
      addMatch(a.points[i], before, now, n.feature);
}

/// `before` is a point of the old map, judged where `preferred` sees it, or else who saw it first.
void PlaceRecognizer::addMatch(PointId before, KeyframeId preferred, KeyframeId now, int feature) {
  const auto observations = map_.observations(before);
  auto seen = std::find_if(observations.begin(), observations.end(),
                           [&](const Observation& o) { return o.keyframe == preferred; });
  if (seen == observations.end()) seen = observations.begin();
  const Keyframe& old_view = map_.keyframe(seen->keyframe);
  const Keyframe& new_view = map_.keyframe(now);
  const Keypoint& ko = old_view.features.keypoints[seen->feature];
  const Keypoint& kn = new_view.features.keypoints[feature];
  sim3_matches_.push_back({map_.point(before).position,
                           map_.point(new_view.points[feature]).position, old_view.T_camera_world,
                           new_view.T_camera_world, atMiddleRow(seen->keyframe, ko, before),
                           atMiddleRow(now, kn, new_view.points[feature]),
                           1 / (ko.sigma * ko.sigma), 1 / (kn.sigma * kn.sigma), true});
}

Eigen::Vector2d PlaceRecognizer::atMiddleRow(KeyframeId keyframe, const Keypoint& seen,
                                             PointId point) const {
  return map_.shutter().atMiddleRow(
      seen, map_.twistOf(keyframe),
      map_.keyframe(keyframe).T_camera_world * map_.point(point).position);
}

void PlaceRecognizer::collectWindow(KeyframeId before) {
  window_.assign(1, before);
  map_.countShared(before, votes_);
  while (static_cast<int>(window_.size()) <= kWindowNeighbours) {
    const auto best = std::max_element(votes_.begin(), votes_.end());
    if (*best < kConnected) break;
    window_.push_back(static_cast<KeyframeId>(best - votes_.begin()));
    *best = 0;
  }
  ++current_stamp_;
  window_points_.clear();
  for (const KeyframeId k : window_) {
    if (isConnected(k)) continue;  // the two ends of a loop nearly touch: the new end is not asked
    for (const PointId p : map_.keyframe(k).points) {
      if (p == kNone || stamp_[p] == current_stamp_) continue;
      if (window_points_.size() == window_points_.capacity()) return;
      stamp_[p] = current_stamp_;
      window_points_.push_back(p);
    }
  }
}

/// Looks for the window's points in `view`, a keyframe of the new side. `matches_[f]`: index into
/// `projected_`, whose `source` is the point. Returns their number.
int PlaceRecognizer::matchWindow(KeyframeId view, const Sim3& T_before_now, double radius_px,
                                 int max_hamming) {
  constexpr double kMaxViewAngleCos = 0.5;  // 60 degrees from the mean viewing direction
  const Keyframe& k = map_.keyframe(view);
  const Sim3 T_view_before = Sim3(k.T_camera_world) * T_before_now.inverse();
  projected_.clear();
  for (const PointId id : window_points_) {
    const MapPoint& point = map_.point(id);
    const Eigen::Vector3d p = T_view_before * point.position;
    if (p.z() < kMinDepth) continue;
    const double distance = p.norm() / T_view_before.s;  // in the old map's unit
    if (distance < 0.8 * point.min_distance || distance > 1.2 * point.max_distance) continue;
    if ((T_view_before.R * point.normal).dot(p) < kMaxViewAngleCos * p.norm()) continue;
    const Eigen::Vector2f px = map_.intrinsics().project(p).cast<float>();
    const int level = map_.predictLevel(point.max_distance, distance);
    projected_.push_back({point.descriptor, px.x(), px.y(),
                          static_cast<float>(radius_px) * map_.scaleOf(level), level - 1, level + 1,
                          id});
  }
  std::fill(matches_.begin(), matches_.end(), kNone);
  return matcher_.matchProjected(k.features, projected_, max_hamming, matcher_.settings().ratio,
                                 matches_);
}

/// Refines the similarity with the points of the window; the number of pairs that agree, 0 when it
/// fails.
int PlaceRecognizer::refineInWindow(const PlaceLink& link, double radius_px, Sim3& T_before_now) {
  matchWindow(link.now, T_before_now, radius_px, matcher_.settings().hamming_loose);
  sim3_matches_.clear();
  const Keyframe& now = map_.keyframe(link.now);
  for (int f = 0; f < now.features.size(); ++f)
    if (matches_[f] >= 0 && now.points[f] != kNone)
      addMatch(projected_[matches_[f]].source, link.before, link.now, f);
  return refineSim3(map_.intrinsics(), sim3_matches_, {}, T_before_now);
}

/// Whether the keyframes around the new one see the old points where the similarity says.
bool PlaceRecognizer::witnessesAgree(const Sim3& T_before_now) {
  const int asked = std::min<int>(kWitnesses, static_cast<int>(neighbours_.size()));
  int agree = 0;
  for (const KeyframeId witness : std::span(neighbours_).first(static_cast<std::size_t>(asked)))
    agree += matchWindow(witness, T_before_now, kNarrowRadius_px,
                         matcher_.settings().hamming_strict) >= kMinFoundByWitness;
  return agree >= std::max<int>(kMinWitnesses, static_cast<int>(kWitnessShare * asked));
}

/// Whether an earlier keyframe found the same: two that do so from different matches are no chance.
/// Where the world was moved in between, by more than a little, they no longer agree.
bool PlaceRecognizer::agreesWithLast(const PlaceLink& link) const {
  if (!unconfirmed_ || pairs_.empty() || !map_.keyframe(unconfirmed_->before).alive ||
      unconfirmed_->now == link.now ||
      map_.keyframe(unconfirmed_->before).map_id != map_.keyframe(link.before).map_id)
    return false;
  const Eigen::Vector3d centre = map_.keyframe(link.now).T_camera_world.inverse().t;
  double difference = 0;
  for (const PointPair& pair : pairs_) {
    const Eigen::Vector3d& p = map_.point(pair.now).position;
    const Eigen::Vector3d moved = link.T_before_now * p;
    difference += (unconfirmed_->T_before_now * p - moved).norm() /
                  (link.T_before_now * centre - moved).norm();
  }
  return difference <= kAgreement * static_cast<double>(pairs_.size());
}

}  // namespace depthscope::slam
