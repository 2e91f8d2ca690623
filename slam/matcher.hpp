#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "slam/descriptor_search.hpp"
#include "slam/features.hpp"
#include "slam/local_map.hpp"
#include "slam/slam_settings.hpp"

namespace depthscope::slam {

/// A map point projected into a picture, and where its feature is to be looked for.
struct ProjectedPoint {
  Descriptor descriptor;
  float u = 0, v = 0;  // [px], undistorted
  float radius = 0;    // [px]
  int min_octave = 0, max_octave = 0;
  std::int32_t source = kNone;  // the caller's index of the point
};

/// In a per-feature array of matches: this feature is not to be matched.
inline constexpr std::int32_t kTaken = -2;

/// Descriptor matching between features, and between features and projected points. Holds scratch
/// space of fixed size; one matcher a thread. All matches are one to one. Radii and thresholds come
/// from MatchingSettings; `search_region` is applied to every radius.
class Matcher {
 public:
  Matcher(const MatchingSettings& settings, int max_features);

  /// Pyramid levels that a map is started from, together: the corners of the next are less certain.
  static constexpr int kInitialLevels = 3;
  /// Matches features of `first`, of `kInitialLevels` levels from `finest` on, with those of
  /// `second` within `radius` of the same place, mutually best, ratio-tested,
  /// orientation-consistent. `matches[i]`: index into second, or kNone. Returns their number.
  int matchForInitialization(const FeatureSet& first, const FeatureSet& second, double radius_px,
                             std::span<int> matches, int finest = 0);

  /// Gives each projected point the feature nearest in descriptor within its window; a feature that
  /// two points want goes to the nearer descriptor. `matches[f]`: in, kTaken or kNone; out, index
  /// into `points` for the features matched. Returns their number.
  int matchProjected(const FeatureSet& features, std::span<const ProjectedPoint> points,
                     int max_hamming, double ratio, std::span<int> matches);

  /// Matches by descriptor alone: for every feature of `from` with `wanted[i]`, its best in `to`;
  /// mutually exclusive, ratio-tested, orientation-consistent. Returns the number of matches.
  int matchByDescriptor(const FeatureSet& from, std::span<const std::uint8_t> wanted,
                        const FeatureSet& to, int max_hamming, double ratio,
                        std::span<int> matches);

  const MatchingSettings& settings() const { return settings_; }

 private:
  int keepConsistentRotations(const FeatureSet& first, const FeatureSet& second,
                              std::span<int> matches);

  MatchingSettings settings_;
  std::vector<std::uint32_t> candidates_;  // indices from the grid
  std::vector<int> best_distance_, reverse_;
  DescriptorSearch search_;
};

}  // namespace depthscope::slam
