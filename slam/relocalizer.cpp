#include "slam/relocalizer.hpp"

#include <algorithm>
#include <array>

namespace depthscope::slam {

namespace {
constexpr std::size_t kAlways = 4;  // one of so many keyframes tried is of the most similar ones
constexpr int kMaxMatches = 150;  // about so many, the nearest in descriptor; few of them are wrong
constexpr int kMinMatches = 15;
constexpr int kMinCluster = 10;  // of those turned and shifted alike; wrong ones make up to 14
// Patches of tissue look much alike: over a whole picture the nearest descriptor is seldom clearly
// nearer than the second, so nothing is refused by ratio: what right matches have in common tells.
constexpr double kRatio = 1.0;
constexpr int kMaxHamming = 80;

/// Corners of tissue seen from aside are found less exactly in the same place: twice the error is
/// allowed for. A wrong match of a cluster still agrees with a pose by chance about once in 2000
/// (area of the inlier window over area of the cluster), so that nine together are no chance; and
/// the local map is asked as well.
PnpSettings pnpSettings() {
  PnpSettings s;
  s.chi2_inlier *= 4;
  s.ransac_iterations = 300;
  s.min_inliers = 9;
  return s;
}
}  // namespace

Relocalizer::Relocalizer(const SlamSettings& settings, const Intrinsics& camera,
                         const KeyframeDatabase& database)
    : camera_(camera),
      matcher_(settings.matching, settings.extractor.capacity()),
      shift_(camera, settings.extractor.capacity()),
      pnp_(pnpSettings(), settings.extractor.capacity()),
      database_(database),
      query_(settings) {
  const std::size_t n = settings.extractor.capacity();
  wanted_.resize(n);
  matches_.resize(n);
  observations_.reserve(n);
  feature_of_observation_.reserve(n);
  point_of_observation_.reserve(n);
}

bool Relocalizer::relocalize(const Map& map, const FeatureSet& features, int keyframes,
                             Pose& T_camera_world, std::span<PointRef> points) {
  const auto places = database_.find(map, features.descriptors, query_);
  const std::size_t tries = std::min(places.size(), static_cast<std::size_t>(keyframes));
  const std::size_t first = (tries + kAlways - 1) / kAlways;
  for (std::size_t i = 0; i < tries; ++i) {
    if (next_ < first || next_ >= places.size()) next_ = first;
    const std::size_t rank = i < first ? i : next_++;
    if (relocalize(map, map.keyframe(places[rank].keyframe), features, T_camera_world, points))
      return true;
  }
  return false;
}

bool Relocalizer::relocalize(const Map& map, const Keyframe& keyframe, const FeatureSet& features,
                             Pose& T_camera_world, std::span<PointRef> points) {
  for (int f = 0; f < keyframe.features.size(); ++f) wanted_[f] = keyframe.points[f] != kNone;
  const int n = matcher_.matchByDescriptor(keyframe.features, wanted_, features, kMaxHamming,
                                           kRatio, matches_);
  if (n < kMinMatches) return false;
  if (shift_.keep(keyframe.features, features, matches_) < kMinCluster) return false;

  takeNearestMatches(map, keyframe, features);
  PnpResult result;
  if (!pnp_.solve(camera_, observations_, result)) return false;
  T_camera_world = result.T_camera_world;
  std::fill(points.begin(), points.end(), PointRef{});
  for (std::size_t i = 0; i < observations_.size(); ++i)
    if (observations_[i].inlier) points[feature_of_observation_[i]] = point_of_observation_[i];
  return true;
}

void Relocalizer::takeNearestMatches(const Map& map, const Keyframe& keyframe,
                                     const FeatureSet& features) {
  std::array<int, kMaxHamming + 1> histogram{};
  const auto distance = [&](int f) {
    return hammingDistance(keyframe.features.descriptors[f], features.descriptors[matches_[f]]);
  };
  for (int f = 0; f < keyframe.features.size(); ++f)
    if (matches_[f] >= 0) ++histogram[distance(f)];
  int limit = -1, within = 0;
  while (limit < kMaxHamming && within < kMaxMatches) within += histogram[++limit];

  observations_.clear();
  feature_of_observation_.clear();
  point_of_observation_.clear();
  for (int f = 0; f < keyframe.features.size(); ++f) {
    if (matches_[f] < 0 || distance(f) > limit) continue;
    const Keypoint& k = features.keypoints[matches_[f]];
    const PointId p = keyframe.points[f];
    observations_.push_back(
        {map.point(p).position, {k.ux, k.uy}, 1 / (k.sigma * k.sigma), 1, true});
    feature_of_observation_.push_back(matches_[f]);
    point_of_observation_.push_back(map.ref(p));
  }
}

}  // namespace depthscope::slam
