#include "slam/two_view_models.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/projection.hpp"
#include "slam/random_sample.hpp"
#include "slam/transfer_errors.hpp"

namespace depthscope::slam {
namespace {

constexpr int kPolishRounds = 3;
constexpr double kConfidence = 0.99;  // that a sample free of outliers has been drawn
constexpr int kFewestSamples = 150;   // of samples free of outliers many differ in their noise

/// Whether a sample free of outliers has been drawn by now (Fischler & Bolles 1981, section II.B),
/// and enough others that the best of them has little noise.
bool enoughSamples(int drawn, double inlier_share) {
  return drawn >= kFewestSamples &&
         drawn * std::log1p(-std::pow(inlier_share, 5)) < std::log(1 - kConfidence);
}

/// Score and inliers of a model whose squared errors must be below `threshold` [sigma^2]. What an
/// error leaves is measured from the homography's threshold for both models, as the paper has it,
/// so that their scores compare. Left unfinished where it can no longer be above `to_beat`.
template <class Errors>
void score(const TwoViewMatches& m, const Errors& errors, double threshold, double sigma_px,
           double to_beat, TwoViewModel& model) {
  const double sigma2 = sigma_px * sigma_px;
  model.score = 0;
  model.inliers = 0;
  for (int i = 0; i < m.size(); i += TransferErrors::block) {
    if (model.score + 2 * kChi2TwoDof95 * (m.size() - i) <= to_beat) return;
    TransferErrors e;
    errors(matchBlock(m, i), e);
    const Left left = whatIsLeft(e, static_cast<float>(threshold * sigma2),
                                 static_cast<float>(kChi2TwoDof95 * sigma2));
    model.score += left.sum / sigma2;
    model.inliers += left.inliers;
  }
}

void tryHomography(const TwoViewMatches& m, std::span<const Eigen::Vector2d> first,
                   std::span<const Eigen::Vector2d> second, double sigma_px, TwoViewModel& best) {
  TwoViewModel model;
  if (!fitHomography(first, second, model.matrix)) return;
  score(m, HomographyErrors(m.camera, model.matrix), kChi2TwoDof95, sigma_px, best.score, model);
  if (model.score > best.score) best = model;
}

/// Rotation that takes bearings of the first view onto those of the second, least squares (Kabsch).
Eigen::Matrix3d rotationFromCovariance(const Eigen::Matrix3d& sum_of_second_firstT) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum_of_second_firstT,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if (U.determinant() * svd.matrixV().determinant() < 0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

Eigen::Matrix3d bearingProduct(const TwoViewMatches& m, int i) {
  const Eigen::Vector3d x1 = m.first[i].homogeneous(), x2 = m.second[i].homogeneous();
  return x2.normalized() * x1.normalized().transpose();
}

}  // namespace

TwoViewMatches::TwoViewMatches(const Intrinsics& intrinsics, int max_matches) : camera(intrinsics) {
  for (auto* v : {&first_px, &second_px, &first, &second}) v->reserve(max_matches);
  for (auto* v : {&first_x, &first_y, &second_x, &second_y}) v->reserve(max_matches);
}

void TwoViewMatches::load(std::span<const Eigen::Vector2f> first_f,
                          std::span<const Eigen::Vector2f> second_f) {
  for (auto* v : {&first_px, &second_px, &first, &second}) v->clear();
  for (auto* v : {&first_x, &first_y, &second_x, &second_y}) v->clear();
  const std::size_t n = std::min({first_f.size(), second_f.size(), first_px.capacity()});
  for (std::size_t i = 0; i < n; ++i) {
    first_x.push_back(first_f[i].x());
    first_y.push_back(first_f[i].y());
    second_x.push_back(second_f[i].x());
    second_y.push_back(second_f[i].y());
    first_px.push_back(first_f[i].cast<double>());
    second_px.push_back(second_f[i].cast<double>());
    first.push_back(camera.normalize(first_px.back()));
    second.push_back(camera.normalize(second_px.back()));
  }
}

TwoViewModelFinder::TwoViewModelFinder(int max_matches) {
  inliers_first_.reserve(max_matches);
  inliers_second_.reserve(max_matches);
}

void TwoViewModelFinder::find(const TwoViewMatches& m, double sigma_px, int iterations,
                              TwoViewModel& homography, TwoViewModel& essential) {
  homography = essential = {};
  std::mt19937 generator(m.size());
  for (int i = 0; i < iterations; ++i) {
    const std::array<int, 5> sample = drawSample<5>(generator, m.size());
    std::array<Eigen::Vector2d, 5> first, second;
    for (int k = 0; k < 5; ++k) {
      first[k] = m.first[sample[k]];
      second[k] = m.second[sample[k]];
    }
    tryHomography(m, std::span(first).first<4>(), std::span(second).first<4>(), sigma_px,
                  homography);
    std::array<Eigen::Matrix3d, 10> candidates;
    const int count = solveEssentialFivePoint(first, second, candidates);
    for (int k = 0; k < count; ++k) {
      TwoViewModel model{candidates[k], 0, 0};
      score(m, EpipolarErrors(m.camera, model.matrix), kChi2OneDof95, sigma_px, essential.score,
            model);
      if (model.score > essential.score) essential = model;
    }
    if (enoughSamples(i + 1, static_cast<double>(essential.inliers) / m.size())) break;
  }
  for (int i = 0; i < kPolishRounds; ++i) polishHomography(m, sigma_px, homography);
}

/// Least squares on the matches that agree with the homography: four matches carry all their noise
/// into it, which would make it look worse than it is beside the essential matrix.
void TwoViewModelFinder::polishHomography(const TwoViewMatches& m, double sigma_px,
                                          TwoViewModel& homography) {
  if (homography.inliers <= 4) return;
  inliers_first_.clear();
  inliers_second_.clear();
  forEachError(m, HomographyErrors(m.camera, homography.matrix),
               [&](int i, float in_second, float in_first) {
                 if (!(std::max(in_second, in_first) < kChi2TwoDof95 * sigma_px * sigma_px)) return;
                 inliers_first_.push_back(m.first[i]);
                 inliers_second_.push_back(m.second[i]);
               });
  tryHomography(m, inliers_first_, inliers_second_, sigma_px, homography);
}

int countRotationInliers(const TwoViewMatches& m, double sigma_px, int iterations) {
  std::mt19937 generator(m.size());
  TwoViewModel best;
  const auto tryRotation = [&](const Eigen::Matrix3d& covariance) {
    TwoViewModel model{rotationFromCovariance(covariance), 0, 0};
    score(m, HomographyErrors(m.camera, model.matrix), kChi2TwoDof95, sigma_px, best.score, model);
    if (model.score > best.score) best = model;
  };
  for (int i = 0; i < iterations; ++i) {
    const auto [a, b] = drawSample<2>(generator, m.size());
    tryRotation(bearingProduct(m, a) + bearingProduct(m, b));
  }
  // Two matches carry all their noise into the rotation: fit it again to everything that agrees.
  for (int i = 0; i < 2; ++i) {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    forEachError(m, HomographyErrors(m.camera, best.matrix), [&](int k, float in_second, float) {
      if (in_second < 4 * kChi2TwoDof95 * sigma_px * sigma_px) covariance += bearingProduct(m, k);
    });
    tryRotation(covariance);
  }
  return best.inliers;
}

}  // namespace depthscope::slam
