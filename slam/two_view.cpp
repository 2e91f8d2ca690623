#include "slam/two_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "slam/epipolar_refinement.hpp"
#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/triangulation.hpp"

namespace depthscope::slam {
namespace {

constexpr int kMinMatches = 8;
constexpr int kRotationIterations = 60;
constexpr int kRefinementRounds = 2, kRefinementIterations = 15;
constexpr double kDegrees = 180 / std::numbers::pi;

/// Between two motions that both place the points: how much more the robust cost of the worse must
/// be, in sigma^2 (a likelihood ratio of e^10) and as a share, for the better to be believed.
constexpr double kDecisiveCost = 20, kDecisiveCostShare = 0.05;

/// Directions of translation closer than this are one optimum, known only so well, and no
/// ambiguity.
constexpr double kSameDirection_rad = 10 / kDegrees;

bool sameMotion(const Pose& a, const Pose& b) {
  return std::atan2(a.t.cross(b.t).norm(), a.t.dot(b.t)) < kSameDirection_rad;
}

}  // namespace

TwoViewInitializer::TwoViewInitializer(const TwoViewSettings& settings, const Intrinsics& camera,
                                       int max_matches)
    : settings_(settings),
      camera_(camera),
      matches_(camera, max_matches),
      adjuster_(2, max_matches, 2 * max_matches),
      finder_(max_matches) {
  parallax_deg_.reserve(max_matches);
  selected_.resize(max_matches);
}

bool TwoViewInitializer::reconstruct(std::span<const Eigen::Vector2f> first,
                                     std::span<const Eigen::Vector2f> second, TwoViewResult& result,
                                     double coarseness) {
  sigma_px_ = settings_.sigma_px * coarseness;
  matches_.load(first, second);
  result.points.assign(first.size(), Eigen::Vector3d::Zero());
  result.triangulated.assign(first.size(), 0);
  result.T_second_first = {};
  result.homography_score = result.median_parallax_deg = 0;
  result.inliers = 0;
  result.refusal = attempt(result);
  return result.refusal == Refusal::None;
}

TwoViewResult::Refusal TwoViewInitializer::attempt(TwoViewResult& result) {
  const int n = matches_.size();
  if (n < std::max(kMinMatches, settings_.min_inliers)) return Refusal::TooFewMatches;

  // The cheap test first: it is the answer for as long as the camera stands still.
  const int rotation_inliers = countRotationInliers(matches_, sigma_px_, kRotationIterations);
  if (rotation_inliers > settings_.max_rotation_share * n) return Refusal::RotationOnly;

  std::span<Hypothesis> contenders;
  if (const Refusal r = proposeMotions(result, contenders); r != Refusal::None) return r;
  if (rotation_inliers > settings_.max_rotation_share * model_inliers_)
    return Refusal::RotationOnly;

  Pose T_second_first;
  if (const Refusal r = chooseMotion(contenders, T_second_first); r != Refusal::None) return r;
  return acceptPoints(T_second_first, result);
}

/// Chooses the model, and collects the motions that either model allows: a plane allows two, and
/// the essential matrix shows but one of them. `contenders` are those that place nearly as many
/// points as the best of them does.
TwoViewResult::Refusal TwoViewInitializer::proposeMotions(TwoViewResult& result,
                                                          std::span<Hypothesis>& contenders) {
  TwoViewModel homography, essential;
  finder_.find(matches_, sigma_px_, settings_.ransac_iterations, homography, essential);
  const double scores = homography.score + essential.score;
  if (!(scores > 0)) return Refusal::TooFewInliers;
  result.homography_score = homography.score / scores;
  const bool planar = result.homography_score > settings_.homography_score_ratio;
  result.model = planar ? TwoViewResult::Model::Homography : TwoViewResult::Model::Essential;
  model_inliers_ = planar ? homography.inliers : essential.inliers;
  if (model_inliers_ < settings_.min_inliers) return Refusal::TooFewInliers;

  std::array<Pose, 8> from_homography;
  std::array<Pose, 4> from_essential;
  const int homography_motions = decomposeHomography(homography.matrix, from_homography);
  decomposeEssential(essential.matrix, from_essential);
  int count = 0;
  for (const Pose& motion : from_essential) hypotheses_[count++].T_second_first = motion;
  for (int k = 0; k < homography_motions; ++k)
    hypotheses_[count++].T_second_first = from_homography[k];

  int most = 0;
  for (Hypothesis& h : std::span(hypotheses_).first(count)) {
    h.points = 0;
    for (int i = 0; i < matches_.size(); ++i) h.points += explains(h.T_second_first, i);
    most = std::max(most, h.points);
  }
  if (most < settings_.min_inliers) return Refusal::PoorFit;
  const auto end =
      std::remove_if(hypotheses_.begin(), hypotheses_.begin() + count,
                     [&](const auto& h) { return h.points < settings_.ambiguity_ratio * most; });
  contenders = {hypotheses_.begin(), end};
  return Refusal::None;
}

/// Refines every contender; what remains must be one motion, or one that fits decisively better.
TwoViewResult::Refusal TwoViewInitializer::chooseMotion(std::span<Hypothesis> contenders,
                                                        Pose& T_second_first) {
  for (Hypothesis& h : contenders) {
    h.direction_sigma_rad = refineMotion(h.T_second_first);
    h.cost = truncatedCost(h.T_second_first);
  }
  std::sort(contenders.begin(), contenders.end(),
            [](const auto& a, const auto& b) { return a.cost < b.cost; });
  const Hypothesis& best = contenders.front();
  for (const Hypothesis& h : contenders.subspan(1)) {
    const double margin = std::max(kDecisiveCost, kDecisiveCostShare * best.cost);
    if (h.cost - best.cost < margin && !sameMotion(h.T_second_first, best.T_second_first))
      return Refusal::Ambiguous;
  }
  if (best.direction_sigma_rad * kDegrees > settings_.max_direction_sigma_deg)
    return Refusal::Uncertain;
  T_second_first = best.T_second_first;
  adjustBundle(T_second_first);
  return Refusal::None;
}

/// Squared errors [sigma^2] of a point, first camera's frame, in either view; infinite where it is
/// not in front of the camera.
TwoViewInitializer::Chi2 TwoViewInitializer::errorsOf(const Pose& T_second_first, int match,
                                                      const Eigen::Vector3d& point) const {
  const auto chi2 = [&](const Eigen::Vector3d& p, const Eigen::Vector2d& pixel) {
    if (p.z() < kMinDepth) return std::numeric_limits<double>::infinity();
    return (camera_.project(p) - pixel).squaredNorm() / (sigma_px_ * sigma_px_);
  };
  return {chi2(point, matches_.first_px[match]),
          chi2(T_second_first * point, matches_.second_px[match])};
}

/// Point of a match, first camera's frame, if it is in front of both cameras and reprojects within
/// the noise; `chi2` is its squared error over both views [sigma^2], whenever there is a point.
bool TwoViewInitializer::triangulateMatch(const Pose& T_second_first, int match,
                                          Eigen::Vector3d& point, double* chi2) const {
  if (!triangulate(Pose{}, matches_.first[match], T_second_first, matches_.second[match], point))
    return false;
  const Chi2 errors = errorsOf(T_second_first, match, point);
  if (chi2) *chi2 = errors.first + errors.second;
  return errors.within();
}

/// Squared error of a match over both views [sigma^2], were its point at infinity: half of the
/// distance is on either side then.
double TwoViewInitializer::costAtInfinity(const Pose& T_second_first, int match) const {
  const Eigen::Vector3d ray = T_second_first.R * matches_.first[match].homogeneous();
  if (ray.z() < kMinDepth) return std::numeric_limits<double>::infinity();
  return (camera_.project(ray) - matches_.second_px[match]).squaredNorm() /
         (2 * sigma_px_ * sigma_px_);
}

/// Whether a point at infinity would be seen where the match is. Of points too far for their
/// parallax noise puts every other one behind the cameras, which speaks for no other motion.
bool TwoViewInitializer::mayBeFar(const Pose& T_second_first, int match) const {
  return costAtInfinity(T_second_first, match) / 2 < kChi2TwoDof95;
}

/// Whether a point in front of both cameras, or at infinity, would be seen where the match is.
bool TwoViewInitializer::explains(const Pose& T_second_first, int match) const {
  // For most matches the cheapest of points will do.
  Eigen::Vector3d point;
  return (rayMidpoint(matches_.first[match], T_second_first, matches_.second[match], point) &&
          errorsOf(T_second_first, match, point).within()) ||
         mayBeFar(T_second_first, match) || triangulateMatch(T_second_first, match, point);
}

/// Epipolar refinement over the matches that agree with the motion, which are then chosen again.
/// Returns the standard deviation of the direction of translation [rad].
double TwoViewInitializer::refineMotion(Pose& T_second_first) {
  double direction_sigma_rad = 0;
  for (int round = 0; round < kRefinementRounds; ++round) {
    for (int i = 0; i < matches_.size(); ++i) selected_[i] = explains(T_second_first, i);
    direction_sigma_rad = refineEpipolarGeometry(matches_, selected_, sigma_px_,
                                                 kRefinementIterations, T_second_first);
  }
  return direction_sigma_rad;
}

/// Bundle adjustment of the motion and the points of all matches that agree with it.
void TwoViewInitializer::adjustBundle(Pose& T_second_first) {
  adjuster_.clear();
  adjuster_.addPose(Pose{}, true);
  adjuster_.addPose(T_second_first, false);
  const float inv_sigma2 = static_cast<float>(1 / (sigma_px_ * sigma_px_));
  for (int i = 0; i < matches_.size(); ++i) {
    Eigen::Vector3d point;
    if (!triangulateMatch(T_second_first, i, point)) continue;
    const int p = adjuster_.addPoint(point);
    adjuster_.addObservation({0, p, matches_.first_px[i].cast<float>(), inv_sigma2, true});
    adjuster_.addObservation({1, p, matches_.second_px[i].cast<float>(), inv_sigma2, true});
  }
  adjuster_.solve(camera_);
  T_second_first = adjuster_.poses()[1].T_camera_world;
  T_second_first.t.normalize();  // the scale is free
}

/// Cost over all matches [sigma^2], which compares between motions.
double TwoViewInitializer::truncatedCost(const Pose& T_second_first) const {
  double cost = 0;
  for (int i = 0; i < matches_.size(); ++i) {
    Eigen::Vector3d point;
    double chi2 = std::numeric_limits<double>::infinity();
    if (!triangulateMatch(T_second_first, i, point, &chi2))
      chi2 = std::min(chi2, costAtInfinity(T_second_first, i));
    cost += std::min(chi2, kChi2TwoDof95);
  }
  return cost;
}

/// Fills in the points of the refined motion and judges whether they are enough to start a map on.
TwoViewResult::Refusal TwoViewInitializer::acceptPoints(const Pose& T_second_first,
                                                        TwoViewResult& result) {
  result.T_second_first = T_second_first;
  const Eigen::Vector3d second_centre = T_second_first.inverse().t;
  parallax_deg_.clear();
  int reliable = 0, far = 0;
  for (int i = 0; i < matches_.size(); ++i) {
    Eigen::Vector3d& point = result.points[i];
    if (!triangulateMatch(T_second_first, i, point)) {
      far += mayBeFar(T_second_first, i);
      continue;
    }
    const double cosine = parallaxCosine(point, Eigen::Vector3d::Zero(), second_centre);
    const double parallax_rad = std::acos(std::clamp(cosine, -1.0, 1.0));
    const double depth_sigma = std::numbers::sqrt2 * sigma_px_ / (camera_.fx * parallax_rad);
    result.triangulated[i] = depth_sigma <= settings_.max_point_depth_sigma;
    result.inliers += result.triangulated[i];
    reliable += depth_sigma <= settings_.max_depth_sigma;
    parallax_deg_.push_back(parallax_rad * kDegrees);
  }
  const auto placed = static_cast<double>(parallax_deg_.size());
  if (placed + far < settings_.min_kept_share * model_inliers_ || placed < settings_.min_inliers)
    return Refusal::PoorFit;
  const auto median = parallax_deg_.begin() + static_cast<std::ptrdiff_t>(parallax_deg_.size() / 2);
  std::nth_element(parallax_deg_.begin(), median, parallax_deg_.end());
  result.median_parallax_deg = *median;
  return reliable < std::max<double>(settings_.min_inliers, settings_.min_reliable_share * placed)
             ? Refusal::LowParallax
             : Refusal::None;
}

}  // namespace depthscope::slam
