#pragma once
#include <vector>

#include "slam/common_shift.hpp"
#include "slam/keyframe_database.hpp"
#include "slam/map.hpp"
#include "slam/matcher.hpp"
#include "slam/pnp.hpp"

namespace depthscope::slam {

/// Finds the camera in the map without knowing where it was: asks the database for keyframes that
/// look like the picture, matches its descriptors with theirs, keeps those that are turned and
/// shifted alike (CommonShift), and solves for the pose by P3P in RANSAC (Mur-Artal et al. 2015,
/// section V.C).
class Relocalizer {
 public:
  Relocalizer(const SlamSettings& settings, const Intrinsics& camera,
              const KeyframeDatabase& database);

  /// Starts over with the ranks at the next call.
  void restart() { next_ = 0; }
  /// Tries up to `keyframes` of them: a quarter are the most similar ones, the others those whose
  /// turn it is by similarity, until every keyframe had its turn. Of a scope put back 40 mm beside
  /// its old place all keyframes were within a tenth of each other in similarity, the right one
  /// among them; after a second of electrosurgery's noise it is the first, wherever among the ranks
  /// the turn has come to. True with a pose, and in `points` (one per feature) the map points it
  /// rests on. The caller verifies it against the local map. Map mutex held.
  bool relocalize(const Map& map, const FeatureSet& features, int keyframes, Pose& T_camera_world,
                  std::span<PointRef> points);
  /// The same from one keyframe.
  bool relocalize(const Map& map, const Keyframe& keyframe, const FeatureSet& features,
                  Pose& T_camera_world, std::span<PointRef> points);

 private:
  /// Of `matches_`, into the observations.
  void takeNearestMatches(const Map& map, const Keyframe& keyframe, const FeatureSet& features);

  Intrinsics camera_;
  Matcher matcher_;
  CommonShift shift_;
  PnpSolver pnp_;
  std::vector<std::uint8_t> wanted_;  // per keyframe feature: sees a point
  std::vector<int> matches_;          // per keyframe feature
  std::vector<PoseObservation> observations_;
  std::vector<int> feature_of_observation_;
  std::vector<PointRef> point_of_observation_;
  const KeyframeDatabase& database_;
  PlaceQuery query_;
  std::size_t next_ = 0;  // rank of the next keyframe whose turn it is
};

}  // namespace depthscope::slam
