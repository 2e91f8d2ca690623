#pragma once
#include <vector>

#include "slam/map.hpp"

namespace depthscope::slam {

/// Triangulates new map points between a keyframe and its neighbours from features that no point
/// explains yet, matched along epipolar lines (Mur-Artal et al. 2015, section VI.C).
class PointCreator {
 public:
  PointCreator(const SlamSettings& settings, Map& map);

  /// Tries all pairs of `keyframe` with `neighbours`; appends the new points to `created` (up to
  /// its capacity). Locks the map's mutex only to write.
  void create(KeyframeId keyframe, std::span<const KeyframeId> neighbours,
              std::vector<PointRef>& created);

 private:
  /// A free feature of the neighbour, with what the search looks at side by side.
  struct Free {
    float u, v, gate;  // [px], [px], [px^2] largest squared distance from the epipolar line
    std::int32_t feature;
  };
  struct DepthRange {
    double nearest, middle, farthest;  // [map unit]
  };
  struct Pair;

  void createWith(KeyframeId keyframe, KeyframeId neighbour, DepthRange depths,
                  std::vector<PointRef>& created);
  void toMiddleRow(KeyframeId keyframe, double depth, std::vector<Eigen::Vector2d>& pixels);
  void matchAlongEpipolarLines(const Pair& pair, DepthRange depths);
  bool accept(const Pair& pair, int feature_a, int feature_b, Eigen::Vector3d& world) const;
  DepthRange depthRange(KeyframeId keyframe);

  MatchingSettings matching_;
  MapperSettings settings_;
  double scale_factor_;
  double max_parallax_cos_, expected_parallax_;  // [rad] the latter
  Map& map_;
  std::vector<Eigen::Vector2d> pixels_a_, pixels_b_;  // per feature of the pair
  std::vector<Free> free_;
  std::vector<int> match_, claimed_by_, claimed_distance_;
  std::vector<double> depths_;
};

}  // namespace depthscope::slam
