#pragma once
#include <vector>

#include "slam/features.hpp"
#include "slam/map.hpp"
#include "slam/matcher.hpp"
#include "slam/two_view.hpp"

namespace depthscope::slam {

/// Waits for two views from which a map can be started. The first view stays the reference as long
/// as enough of its features are found again; a camera that stands still or only turns never
/// passes.
class MapInitializer {
 public:
  MapInitializer(const SlamSettings& settings, const CameraModel& camera);

  /// Offers the next picture. True when a map was made out of the reference view and this one: two
  /// keyframes and the points between them, median depth 1, as a new connected map
  /// that becomes the active one. `map` must have two free keyframe slots; its mutex is held.
  bool offer(const FeatureSet& features, std::int64_t frame, double timestamp_s, Map& map);
  void reset() { has_reference_ = false; }

 private:
  void setReference(const FeatureSet& features, std::int64_t frame, double timestamp_s);
  int match(const FeatureSet& features, int finest);
  bool buildMap(const FeatureSet& features, std::int64_t frame, double timestamp_s, Map& map);

  InitializerSettings settings_;
  Matcher matcher_;
  TwoViewInitializer two_view_;
  TwoViewResult result_;
  FeatureSet reference_;
  std::int64_t reference_frame_ = 0;
  double reference_timestamp_s_ = 0;
  bool has_reference_ = false;
  std::vector<int> matches_;  // per reference feature
  std::vector<int> matched_;  // reference feature of each matched pair
  std::vector<Eigen::Vector2f> first_, second_;
};

}  // namespace depthscope::slam
