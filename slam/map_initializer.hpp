#pragma once
#include <vector>

#include "slam/feature_follower.hpp"
#include "slam/map.hpp"
#include "slam/matcher.hpp"
#include "slam/spare_features.hpp"
#include "slam/two_view.hpp"

namespace depthscope::slam {

/// Waits for two views from which a map can be started. The first view stays the reference as long
/// as enough of its features are found again, by their descriptors or, where noise drowns those, by
/// optical flow; a camera that stands still or only turns never
/// passes.
class MapInitializer {
 public:
  /// `extractor` is the one that the pictures' features come from.
  MapInitializer(const SlamSettings& settings, const CameraModel& camera,
                 const OrbExtractor& extractor);

  /// Offers the next picture. True when a map was made out of the reference view and this one: two
  /// keyframes and the points between them, median depth 1, as a new connected map
  /// that becomes the active one. What was found by flow becomes features of this view then. `map`
  /// must have two free keyframe slots; its mutex is held.
  bool offer(FeatureSet& features, std::int64_t frame, double timestamp_s, Map& map);
  void reset() { has_reference_ = false; }

 private:
  void setReference(const FeatureSet& features, std::int64_t frame, double timestamp_s);
  bool findAgain(const FeatureSet& features);
  int match(const FeatureSet& features, int finest);
  void pairMatched(const FeatureSet& features);
  void pairFollowed();
  void makeFeatures(FeatureSet& features);
  bool buildMap(const FeatureSet& features, std::int64_t frame, double timestamp_s, Map& map);

  InitializerSettings settings_;
  Matcher matcher_;
  TwoViewInitializer two_view_;
  TwoViewResult result_;
  FeatureSet reference_;
  std::int64_t reference_frame_ = 0;
  double reference_timestamp_s_ = 0;
  bool has_reference_ = false;
  const OrbExtractor& extractor_;
  FeatureFollower follower_;  // of the reference's features
  SpareFeatures spare_;
  bool following_ = false;    // since the reference's descriptors were not found
  int finest_ = 0;            // octave of the features that the pairs are of
  std::vector<int> matches_;  // per reference feature
  std::vector<int> matched_;  // reference feature of each matched pair
  std::vector<Eigen::Vector2f> first_, second_;
};

}  // namespace depthscope::slam
