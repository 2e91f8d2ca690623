#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/bundle_adjuster.hpp"
#include "slam/intrinsics.hpp"
#include "slam/projection.hpp"
#include "slam/two_view_models.hpp"
#include "types/pose.hpp"

namespace depthscope::slam {

struct TwoViewSettings {
  double sigma_px = 1;                 // of a keypoint's position
  int ransac_iterations = 200;         // at most: TwoViewModelFinder
  int min_inliers = 50;                // matches that agree with the model, and points in the end
  double max_depth_sigma = 0.2;        // relative, of `min_inliers` points at least
  double min_reliable_share = 0.25;    // of the points that must have such a depth
  double max_point_depth_sigma = 0.5;  // above it a point is not handed on: its depth is a guess
  double homography_score_ratio =
      0.45;                         // R_H above: homography (Mur-Artal et al. 2015, section IV)
  double max_rotation_share = 0.6;  // of the inliers that a rotation alone explains as well
  double ambiguity_ratio =
      0.7;  // a motion that places this share of the points the best does competes
  double max_direction_sigma_deg =
      4;                        // of the translation, as the matches and sigma_px foretell it
  double min_kept_share = 0.7;  // of the model's inliers that the motion must explain
};

struct TwoViewResult {
  enum class Model { Homography, Essential };
  /// Why there is no reconstruction.
  enum class Refusal {
    None,
    TooFewMatches,
    TooFewInliers,
    RotationOnly,  // includes a camera that stands still
    Ambiguous,     // two motions explain the matches about as well
    LowParallax,   // too few points have a depth to rely on
    Uncertain,     // the direction of the translation is hardly determined
    PoorFit,       // too few of the inliers fit, or became points
  };

  Refusal refusal = Refusal::None;
  Model model = Model::Essential;
  double homography_score = 0;             // R_H = S_H / (S_H + S_E), 0..1
  Pose T_second_first;                     // |t| = 1
  std::vector<Eigen::Vector3d> points;     // per match, first camera's frame, in units of |t|
  std::vector<std::uint8_t> triangulated;  // per match: 1 if its point may be used
  double median_parallax_deg = 0;
  int inliers = 0;  // number of matches triangulated
};

/// Structure and motion from matches between two views, without asking for a planar or a general
/// scene (Mur-Artal et al. 2015, section IV): homography and essential matrix are fitted side by
/// side, one is chosen by score, its motion hypotheses compete by the points they put in front of
/// both cameras, and the winner is refined by bundle adjustment. It refuses rather than guess.
/// Deterministic. All storage is allocated by the constructor; a result that is used again is not
/// reallocated.
class TwoViewInitializer {
 public:
  TwoViewInitializer(const TwoViewSettings& settings, const Intrinsics& camera, int max_matches);

  /// first[i] and second[i]: undistorted pixels of match i. Matches beyond max_matches are ignored.
  /// True if `result` holds a reconstruction; else its `refusal` says why not. Places are uncertain
  /// by the settings' sigma_px times `coarseness`.
  bool reconstruct(std::span<const Eigen::Vector2f> first, std::span<const Eigen::Vector2f> second,
                   TwoViewResult& result, double coarseness = 1);

 private:
  using Refusal = TwoViewResult::Refusal;
  struct Chi2 {
    double first, second;
    bool within() const { return std::max(first, second) < kChi2TwoDof95; }
  };
  struct Hypothesis {
    Pose T_second_first;
    int points = 0;   // matches that it explains
    double cost = 0;  // robust, [sigma^2], after refinement
    double direction_sigma_rad = 0;
  };

  Refusal attempt(TwoViewResult& result);
  Refusal proposeMotions(TwoViewResult& result, std::span<Hypothesis>& contenders);
  Refusal chooseMotion(std::span<Hypothesis> contenders, Pose& T_second_first);
  Refusal acceptPoints(const Pose& T_second_first, TwoViewResult& result);
  Chi2 errorsOf(const Pose& T_second_first, int match, const Eigen::Vector3d& point) const;
  bool triangulateMatch(const Pose& T_second_first, int match, Eigen::Vector3d& point,
                        double* chi2 = nullptr) const;
  double costAtInfinity(const Pose& T_second_first, int match) const;
  bool mayBeFar(const Pose& T_second_first, int match) const;
  bool explains(const Pose& T_second_first, int match) const;
  double refineMotion(Pose& T_second_first);
  void adjustBundle(Pose& T_second_first);
  double truncatedCost(const Pose& T_second_first) const;

  TwoViewSettings settings_;
  double sigma_px_ = 1;  // of the matches at hand
  Intrinsics camera_;
  TwoViewMatches matches_;
  BundleAdjuster adjuster_;
  TwoViewModelFinder finder_;
  std::array<Hypothesis, 12> hypotheses_;
  std::vector<std::uint8_t> selected_;  // per match, scratch
  int model_inliers_ = 0;               // matches that agree with the model chosen
  std::vector<double> parallax_deg_;    // scratch for the median
};

}  // namespace depthscope::slam
