#include "slam/matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace depthscope::slam {

namespace {

constexpr int kFar = 257;  // farther than any two descriptors

struct BestTwo {
  int index = kNone, distance = kFar, octave = -1;
  int second_distance = kFar, second_octave = -1;

  void offer(int i, int d, int o) {
    if (d < distance) {
      second_distance = distance;
      second_octave = octave;
      index = i;
      distance = d;
      octave = o;
    } else if (d < second_distance) {
      second_distance = d;
      second_octave = o;
    }
  }
};

}  // namespace

Matcher::Matcher(const MatchingSettings& settings, int max_features)
    : settings_(settings), search_(max_features) {
  candidates_.resize(max_features);
  best_distance_.resize(max_features);
  reverse_.resize(max_features);
}

int Matcher::matchForInitialization(const FeatureSet& first, const FeatureSet& second,
                                    double radius_px, std::span<int> matches, int finest) {
  std::fill(matches.begin(), matches.end(), kNone);
  std::fill(reverse_.begin(), reverse_.end(), kNone);
  std::fill(best_distance_.begin(), best_distance_.end(), kFar);
  for (int i = 0; i < first.size(); ++i) {
    const Keypoint& k = first.keypoints[i];
    if (k.octave < finest || k.octave >= finest + kInitialLevels) continue;
    const int n = second.grid.query(k.ux, k.uy, static_cast<float>(radius_px),
                                    std::max(finest, k.octave - 1), k.octave + 1, candidates_);
    BestTwo best;
    for (int c = 0; c < n; ++c) {
      const int j = static_cast<int>(candidates_[c]);
      const int d = hammingDistance(first.descriptors[i], second.descriptors[j]);
      if (d < best_distance_[j]) best.offer(j, d, 0);
    }
    if (best.distance > settings_.hamming_strict) continue;
    if (best.distance > settings_.ratio * best.second_distance) continue;
    if (reverse_[best.index] != kNone) matches[reverse_[best.index]] = kNone;
    matches[i] = best.index;
    reverse_[best.index] = i;
    best_distance_[best.index] = best.distance;
  }
  return keepConsistentRotations(first, second, matches);
}

int Matcher::matchProjected(const FeatureSet& features, std::span<const ProjectedPoint> points,
                            int max_hamming, double ratio, std::span<int> matches) {
  std::fill(best_distance_.begin(), best_distance_.end(), kFar);
  int matched = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const ProjectedPoint& point = points[p];
    const float radius = point.radius * static_cast<float>(settings_.search_region);
    const int n = features.grid.query(point.u, point.v, radius, point.min_octave, point.max_octave,
                                      candidates_);
    BestTwo best;
    for (int c = 0; c < n; ++c) {
      const int f = static_cast<int>(candidates_[c]);
      if (matches[f] == kTaken) continue;
      const int d = hammingDistance(point.descriptor, features.descriptors[f]);
      if (d < best_distance_[f]) best.offer(f, d, features.keypoints[f].octave);
    }
    if (best.distance > max_hamming) continue;
    if (best.octave == best.second_octave && best.distance > ratio * best.second_distance) continue;
    if (matches[best.index] == kNone) ++matched;
    matches[best.index] = static_cast<int>(p);
    best_distance_[best.index] = best.distance;
  }
  return matched;
}

int Matcher::matchByDescriptor(const FeatureSet& from, std::span<const std::uint8_t> wanted,
                               const FeatureSet& to, int max_hamming, double ratio,
                               std::span<int> matches) {
  std::fill(matches.begin(), matches.end(), kNone);
  std::fill(reverse_.begin(), reverse_.end(), kNone);
  std::fill(best_distance_.begin(), best_distance_.end(), kFar);
  search_.assign(to.descriptors);
  for (int i = 0; i < from.size(); ++i) {
    if (!wanted[i]) continue;
    const DescriptorSearch::Nearest best = search_.nearest(from.descriptors[i]);
    if (best.distance > max_hamming || best.distance > ratio * best.second_distance) continue;
    if (best.distance >= best_distance_[best.index]) continue;
    if (reverse_[best.index] != kNone) matches[reverse_[best.index]] = kNone;
    matches[i] = best.index;
    reverse_[best.index] = i;
    best_distance_[best.index] = best.distance;
  }
  return keepConsistentRotations(from, to, matches);
}

int Matcher::keepConsistentRotations(const FeatureSet& first, const FeatureSet& second,
                                     std::span<int> matches) {
  // A rigid view turns all patches alike: keep the three fullest of 30 bins of the difference in
  // angle (Mur-Artal et al. 2015), the lesser two only if at least a tenth of the fullest.
  constexpr int kBins = 30;
  const auto binOf = [&](int i) {
    const double turn = 2 * std::numbers::pi;
    double d = std::fmod(first.keypoints[i].angle - second.keypoints[matches[i]].angle, turn);
    if (d < 0) d += turn;
    return std::min(kBins - 1, static_cast<int>(d * kBins / turn + 0.5) % kBins);
  };
  std::array<int, kBins> histogram{};
  for (int i = 0; i < first.size(); ++i)
    if (matches[i] >= 0) ++histogram[binOf(i)];
  std::array<int, kBins> sorted = histogram;
  std::nth_element(sorted.begin(), sorted.begin() + 2, sorted.end(), std::greater<>());
  const int fullest = *std::max_element(sorted.begin(), sorted.end());
  const int least = std::max({1, sorted[2], (fullest + 9) / 10});
  int kept = 0;
  for (int i = 0; i < first.size(); ++i) {
    if (matches[i] < 0) continue;
    if (histogram[binOf(i)] < least)
      matches[i] = kNone;
    else
      ++kept;
  }
  return kept;
}

}  // namespace depthscope::slam
