#include "slam/two_view_models.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/projection.hpp"
#include "slam/random_sample.hpp"

namespace depthscope::slam {
namespace {

constexpr int kPolishRounds = 3;

Eigen::Matrix3d cameraMatrix(const Intrinsics& c) {
  Eigen::Matrix3d K;
  K << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  return K;
}

/// Squared errors of a match in both directions [px^2].
struct TransferErrors {
  double in_second, in_first;
};

/// Symmetric transfer error of x2 ~ H x1 on pixels.
class HomographyErrors {
 public:
  HomographyErrors(const Intrinsics& camera, const Eigen::Matrix3d& H) {
    const Eigen::Matrix3d K = cameraMatrix(camera);
    H_second_first_ = K * H * K.inverse();
    H_first_second_ = H_second_first_.inverse();
  }
  TransferErrors operator()(const Eigen::Vector2d& first, const Eigen::Vector2d& second) const {
    return {distance2(H_second_first_, first, second), distance2(H_first_second_, second, first)};
  }

 private:
  static double distance2(const Eigen::Matrix3d& H, const Eigen::Vector2d& from,
                          const Eigen::Vector2d& to) {
    const double w = H(2, 0) * from.x() + H(2, 1) * from.y() + H(2, 2);
    const double dx = (H(0, 0) * from.x() + H(0, 1) * from.y() + H(0, 2)) / w - to.x();
    const double dy = (H(1, 0) * from.x() + H(1, 1) * from.y() + H(1, 2)) / w - to.y();
    return dx * dx + dy * dy;
  }
  Eigen::Matrix3d H_second_first_, H_first_second_;
};

/// Distances to the epipolar lines, on pixels.
class EpipolarErrors {
 public:
  EpipolarErrors(const Intrinsics& camera, const Eigen::Matrix3d& E) {
    const Eigen::Matrix3d K_inv = cameraMatrix(camera).inverse();
    F_ = K_inv.transpose() * E * K_inv;
  }
  TransferErrors operator()(const Eigen::Vector2d& first, const Eigen::Vector2d& second) const {
    const double a = F_(0, 0) * first.x() + F_(0, 1) * first.y() + F_(0, 2);
    const double b = F_(1, 0) * first.x() + F_(1, 1) * first.y() + F_(1, 2);
    const double c = F_(2, 0) * first.x() + F_(2, 1) * first.y() + F_(2, 2);
    const double a2 = F_(0, 0) * second.x() + F_(1, 0) * second.y() + F_(2, 0);
    const double b2 = F_(0, 1) * second.x() + F_(1, 1) * second.y() + F_(2, 1);
    const double e = a * second.x() + b * second.y() + c, e2 = e * e;
    return {e2 / (a * a + b * b), e2 / (a2 * a2 + b2 * b2)};
  }

 private:
  Eigen::Matrix3d F_;
};

/// Score and inliers of a model whose squared errors must be below `threshold` [sigma^2]. What an
/// error leaves is measured from the homography's threshold for both models, as the paper has it,
/// so that their scores compare. Left unfinished where it can no longer be above `to_beat`.
template <class Errors>
void score(const TwoViewMatches& m, const Errors& errors, double threshold, double sigma_px,
           double to_beat, TwoViewModel& model) {
  constexpr int kBlock = 32;
  const double inv_sigma2 = 1 / (sigma_px * sigma_px);
  model.score = 0;
  model.inliers = 0;
  for (int i = 0; i < m.size(); ++i) {
    if (i % kBlock == 0 && model.score + 2 * kChi2TwoDof95 * (m.size() - i) <= to_beat) return;
    const TransferErrors e = errors(m.first_px[i], m.second_px[i]);
    const double e1 = e.in_second * inv_sigma2, e2 = e.in_first * inv_sigma2;
    const bool ok1 = e1 < threshold, ok2 = e2 < threshold;
    if (ok1) model.score += kChi2TwoDof95 - e1;
    if (ok2) model.score += kChi2TwoDof95 - e2;
    model.inliers += ok1 && ok2;
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
}

void TwoViewMatches::load(std::span<const Eigen::Vector2f> first_f,
                          std::span<const Eigen::Vector2f> second_f) {
  for (auto* v : {&first_px, &second_px, &first, &second}) v->clear();
  const std::size_t n = std::min({first_f.size(), second_f.size(), first_px.capacity()});
  for (std::size_t i = 0; i < n; ++i) {
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
  }
  for (int i = 0; i < kPolishRounds; ++i) polishHomography(m, sigma_px, homography);
}

/// Least squares on the matches that agree with the homography: four matches carry all their noise
/// into it, which would make it look worse than it is beside the essential matrix.
void TwoViewModelFinder::polishHomography(const TwoViewMatches& m, double sigma_px,
                                          TwoViewModel& homography) {
  if (homography.inliers <= 4) return;
  const HomographyErrors errors(m.camera, homography.matrix);
  inliers_first_.clear();
  inliers_second_.clear();
  for (int i = 0; i < m.size(); ++i) {
    const TransferErrors e = errors(m.first_px[i], m.second_px[i]);
    if (std::max(e.in_first, e.in_second) >= kChi2TwoDof95 * sigma_px * sigma_px) continue;
    inliers_first_.push_back(m.first[i]);
    inliers_second_.push_back(m.second[i]);
  }
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
    const HomographyErrors errors(m.camera, best.matrix);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (int k = 0; k < m.size(); ++k) {
      const TransferErrors e = errors(m.first_px[k], m.second_px[k]);
      if (e.in_second < 4 * kChi2TwoDof95 * sigma_px * sigma_px) covariance += bearingProduct(m, k);
    }
    tryRotation(covariance);
  }
  return best.inliers;
}

}  // namespace depthscope::slam
