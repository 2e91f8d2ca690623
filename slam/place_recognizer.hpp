#pragma once
#include <optional>
#include <span>
#include <vector>

#include "slam/cross_map_locator.hpp"
#include "slam/keyframe_database.hpp"
#include "slam/matcher.hpp"
#include "slam/sim3_solver.hpp"

namespace depthscope::slam {

/// A point of the place as it was mapped before, and the one that was made of the same tissue now.
struct PointPair {
  PointId before = kNone;
  PointId now = kNone;
};

/// The place a keyframe shows was mapped before: in another connected map, or so long ago in its
/// own that nothing connects the two.
struct PlaceLink {
  KeyframeId now = kNone, before = kNone;
  Sim3 T_before_now;  // takes a point from where `now` has it to where `before` has it
  int matches = 0;    // features of `now` that agree with it
};

/// Recognises places that are in the map twice (Mur-Artal et al. 2015, section VII.A and B): asks
/// the database, finds the similarity by RANSAC, refines it with points searched for under its
/// guidance, and has it confirmed by the keyframes around, or by the next keyframe that finds the
/// same similarity from scratch. Keyframes of other maps are tried one after the other as well, as
/// if the camera were lost. Rather misses a place than mistakes one. Called by the mapper; reads
/// the map without its mutex. Allocates nothing.
class PlaceRecognizer {
 public:
  PlaceRecognizer(const SlamSettings& settings, const Map& map, const KeyframeDatabase& database);

  std::optional<PlaceLink> recognize(KeyframeId keyframe);

  /// Of the last link: the keyframe before and those around it, the points of the link that both
  /// have, in the order of `now`'s features.
  std::span<const KeyframeId> window() const { return window_; }
  std::span<const PointPair> pairs() const { return pairs_; }

 private:
  bool isConnected(KeyframeId keyframe) const { return shared_[keyframe] >= kConnected; }
  double leastSimilarityAround(KeyframeId keyframe);
  std::optional<PlaceLink> examine(KeyframeId now, KeyframeId before);
  std::optional<PlaceLink> locateElsewhere(KeyframeId now);
  std::optional<PlaceLink> verify(PlaceLink link);
  void matchPoints(KeyframeId now, KeyframeId before);
  void addMatch(PointId before, KeyframeId preferred, KeyframeId now, int feature);
  Eigen::Vector2d atMiddleRow(KeyframeId keyframe, const Keypoint& seen, PointId point) const;
  void collectWindow(KeyframeId before);
  int matchWindow(KeyframeId view, const Sim3& T_before_now, double radius_px, int max_hamming);
  int refineInWindow(const PlaceLink& link, double radius_px, Sim3& T_before_now);
  bool witnessesAgree(const Sim3& T_before_now);
  bool agreesWithLast(const PlaceLink& link) const;

  static constexpr int kConnected = 15;  // shared points that make two keyframes neighbours

  const Map& map_;
  const KeyframeDatabase& database_;
  Matcher matcher_;
  CrossMapLocator locator_;
  PlaceQuery query_, score_query_;
  std::vector<int> shared_;             // per keyframe: points it shares with the one in question
  std::vector<KeyframeId> neighbours_;  // of the keyframe in question, most shared points first
  std::vector<int> votes_;              // per keyframe, scratch
  std::vector<int> matches_;            // per feature
  struct Nearest {
    int feature = kNone, distance = 257;
  };
  std::vector<Nearest> nearest_now_;     // per feature of `before`
  std::vector<Nearest> nearest_before_;  // per feature of `now`
  std::vector<Sim3Match> sim3_matches_;
  std::vector<KeyframeId> window_;
  std::vector<PointId> window_points_;  // each once
  std::vector<std::int64_t> stamp_;     // per point: collectWindow() that last took it
  std::int64_t current_stamp_ = 0;
  std::vector<ProjectedPoint> projected_;
  std::vector<PointPair> pairs_;
  std::optional<PlaceLink> unconfirmed_;  // found by an earlier keyframe
};

}  // namespace depthscope::slam
