#include "slam/two_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/projection.hpp"
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

/// Motions closer than this are one and the same optimum, reached from two sides.
constexpr double kSameMotion_rad = 0.2 / kDegrees;

bool sameMotion(const Pose& a, const Pose& b) {
  const double rotation = logSO3(a.R * b.R.transpose()).norm();
  const double direction = std::atan2(a.t.cross(b.t).norm(), a.t.dot(b.t));
  return rotation < kSameMotion_rad && direction < 10 * kSameMotion_rad;
}

}  // namespace

TwoViewInitializer::TwoViewInitializer(const TwoViewSettings& settings, const Intrinsics& camera,
                                       int max_matches)
    : settings_(settings),
      camera_(camera),
      matches_(camera, max_matches),
      adjuster_(2, max_matches, 2 * max_matches) {
  parallax_deg_.reserve(max_matches);
  selected_.resize(max_matches);
}

bool TwoViewInitializer::reconstruct(std::span<const Eigen::Vector2f> first,
                                     std::span<const Eigen::Vector2f> second,
                                     TwoViewResult& result) {
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
  const int rotation_inliers =
      countRotationInliers(matches_, settings_.sigma_px, kRotationIterations);
  if (rotation_inliers > settings_.max_rotation_share * n) return Refusal::RotationOnly;

  std::span<Hypothesis> contenders;
  if (const Refusal r = proposeMotions(result, contenders); r != Refusal::None) return r;
  if (rotation_inliers > settings_.max_rotation_share * model_inliers_)
    return Refusal::RotationOnly;

  Pose T_second_first;
  if (const Refusal r = chooseMotion(contenders, T_second_first); r != Refusal::None) return r;
  return acceptPoints(T_second_first, result);
}

/// Chooses the model and decomposes it; `contenders` are the motions that place nearly as many
/// points as the best of them does, the best one first.
TwoViewResult::Refusal TwoViewInitializer::proposeMotions(TwoViewResult& result,
                                                          std::span<Hypothesis>& contenders) {
  TwoViewModel homography, essential;
  findTwoViewModels(matches_, settings_.sigma_px, settings_.ransac_iterations, homography,
                    essential);
  const double scores = homography.score + essential.score;
  if (!(scores > 0)) return Refusal::TooFewInliers;
  result.homography_score = homography.score / scores;
  const bool planar = result.homography_score > settings_.homography_score_ratio;
  result.model = planar ? TwoViewResult::Model::Homography : TwoViewResult::Model::Essential;

  std::array<Pose, 8> motions;
  int count = 4;
  if (planar) {
    model_inliers_ =
        markHomographyInliers(matches_, homography.matrix, settings_.sigma_px, selected_);
    count = decomposeHomography(homography.matrix, motions);
  } else {
    model_inliers_ =
        markEssentialInliers(matches_, essential.matrix, settings_.sigma_px, selected_);
    std::array<Pose, 4> four;
    decomposeEssential(essential.matrix, four);
    std::copy(four.begin(), four.end(), motions.begin());
  }
  if (model_inliers_ < settings_.min_inliers) return Refusal::TooFewInliers;

  for (int k = 0; k < count; ++k) {
    hypotheses_[k] = {motions[k], 0, 0};
    Eigen::Vector3d point;
    for (int i = 0; i < matches_.size(); ++i)
      hypotheses_[k].points += selected_[i] && triangulateMatch(motions[k], i, point);
  }
  const auto begin = hypotheses_.begin(), end = begin + count;
  std::sort(begin, end, [](const auto& a, const auto& b) { return a.points > b.points; });
  if (count == 0 || begin->points < settings_.min_inliers) return Refusal::PoorFit;
  const double enough = settings_.ambiguity_ratio * begin->points;
  contenders = {begin, std::find_if(begin, end, [&](const auto& h) { return h.points < enough; })};
  return Refusal::None;
}

/// Refines every contender; what remains must be one motion, or one that fits decisively better.
TwoViewResult::Refusal TwoViewInitializer::chooseMotion(std::span<Hypothesis> contenders,
                                                        Pose& T_second_first) {
  for (Hypothesis& h : contenders) h.cost = refine(h.T_second_first);
  std::sort(contenders.begin(), contenders.end(),
            [](const auto& a, const auto& b) { return a.cost < b.cost; });
  const Hypothesis& best = contenders.front();
  for (const Hypothesis& h : contenders.subspan(1)) {
    const double margin = std::max(kDecisiveCost, kDecisiveCostShare * best.cost);
    if (h.cost - best.cost < margin && !sameMotion(h.T_second_first, best.T_second_first))
      return Refusal::Ambiguous;
  }
  T_second_first = best.T_second_first;
  return Refusal::None;
}

/// Point of a match, first camera's frame, if it is in front of both cameras and reprojects within
/// the noise; `chi2` is its squared error over both views [sigma^2], whenever there is a point.
bool TwoViewInitializer::triangulateMatch(const Pose& T_second_first, int match,
                                          Eigen::Vector3d& point, double* chi2) const {
  if (!triangulate(Pose{}, matches_.first[match], T_second_first, matches_.second[match], point))
    return false;
  const double inv_sigma2 = 1 / (settings_.sigma_px * settings_.sigma_px);
  const double first = (camera_.project(point) - matches_.first_px[match]).squaredNorm();
  const double second =
      (camera_.project(T_second_first * point) - matches_.second_px[match]).squaredNorm();
  if (chi2) *chi2 = (first + second) * inv_sigma2;
  return std::max(first, second) * inv_sigma2 < kChi2TwoDof95;
}

/// Bundle adjustment of motion and points over all matches that agree with the motion, which are
/// then chosen again. Returns the truncated cost over all matches, which compares between motions.
double TwoViewInitializer::refine(Pose& T_second_first) {
  BaSettings settings;
  settings.max_iterations = kRefinementIterations;
  const float inv_sigma2 = static_cast<float>(1 / (settings_.sigma_px * settings_.sigma_px));
  for (int round = 0; round < kRefinementRounds; ++round) {
    adjuster_.clear();
    adjuster_.addPose(Pose{}, true);
    adjuster_.addPose(T_second_first, false);
    for (int i = 0; i < matches_.size(); ++i) {
      Eigen::Vector3d point;
      if (!triangulateMatch(T_second_first, i, point)) continue;
      const int p = adjuster_.addPoint(point);
      adjuster_.addObservation({0, p, matches_.first_px[i].cast<float>(), inv_sigma2, true});
      adjuster_.addObservation({1, p, matches_.second_px[i].cast<float>(), inv_sigma2, true});
    }
    adjuster_.solve(camera_, settings);
    T_second_first = adjuster_.poses()[1].T_camera_world;
    T_second_first.t.normalize();  // the scale is free
  }
  double cost = 0;
  for (int i = 0; i < matches_.size(); ++i) {
    Eigen::Vector3d point;
    double chi2 = std::numeric_limits<double>::infinity();
    triangulateMatch(T_second_first, i, point, &chi2);
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
  for (int i = 0; i < matches_.size(); ++i) {
    Eigen::Vector3d& point = result.points[i];
    if (!triangulateMatch(T_second_first, i, point)) continue;
    const double cosine = parallaxCosine(point, Eigen::Vector3d::Zero(), second_centre);
    parallax_deg_.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees);
    result.triangulated[i] = parallax_deg_.back() >= settings_.min_point_parallax_deg;
    result.inliers += result.triangulated[i];
  }
  const auto placed = static_cast<double>(parallax_deg_.size());
  if (placed < settings_.min_kept_share * model_inliers_ || placed < settings_.min_inliers)
    return Refusal::PoorFit;
  const auto median = parallax_deg_.begin() + static_cast<std::ptrdiff_t>(parallax_deg_.size() / 2);
  std::nth_element(parallax_deg_.begin(), median, parallax_deg_.end());
  result.median_parallax_deg = *median;
  if (*median < settings_.min_parallax_deg) return Refusal::LowParallax;
  return result.inliers < settings_.min_inliers ? Refusal::TooFewInliers : Refusal::None;
}

}  // namespace depthscope::slam
