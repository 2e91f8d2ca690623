#include "slam/two_view_models.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>

#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/projection.hpp"
#include "slam/random_sample.hpp"
#include "types/vector_clones.hpp"

namespace depthscope::slam {
namespace {

constexpr int kPolishRounds = 3;

Eigen::Matrix3d cameraMatrix(const Intrinsics& c) {
  Eigen::Matrix3d K;
  K << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  return K;
}

constexpr int kLanes = 8;   // sums that run side by side
constexpr int kBlock = 32;  // matches, a multiple of kLanes

/// Squared errors [px^2] of a block of matches, in either view.
struct TransferErrors {
  std::array<float, kBlock> in_second, in_first;
};

/// Matches of a block: `count` of them, in places aligned with one another.
struct MatchBlock {
  const float *first_x, *first_y, *second_x, *second_y;  // [px]
  int count;
};

MatchBlock blockAt(const TwoViewMatches& m, int begin) {
  return {m.first_x.data() + begin, m.first_y.data() + begin, m.second_x.data() + begin,
          m.second_y.data() + begin, std::min(kBlock, m.size() - begin)};
}

using RowMajor3f = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

/// Squared distances between what the homography makes of places and where they are.
DEPTHSCOPE_CLONES
void transferDistances(const float* __restrict H, const float* __restrict from_x,
                       const float* __restrict from_y, const float* __restrict to_x,
                       const float* __restrict to_y, int count, float* __restrict distances) {
  for (int i = 0; i < count; ++i) {
    const float w = H[6] * from_x[i] + H[7] * from_y[i] + H[8];
    const float dx = (H[0] * from_x[i] + H[1] * from_y[i] + H[2]) / w - to_x[i];
    const float dy = (H[3] * from_x[i] + H[4] * from_y[i] + H[5]) / w - to_y[i];
    distances[i] = dx * dx + dy * dy;
  }
}

/// Squared distances to the epipolar lines in both views.
DEPTHSCOPE_CLONES
void epipolarDistances(const float* __restrict F, const MatchBlock& m, float* __restrict in_second,
                       float* __restrict in_first) {
  for (int i = 0; i < m.count; ++i) {
    const float x1 = m.first_x[i], y1 = m.first_y[i], x2 = m.second_x[i], y2 = m.second_y[i];
    const float a = F[0] * x1 + F[1] * y1 + F[2];
    const float b = F[3] * x1 + F[4] * y1 + F[5];
    const float c = F[6] * x1 + F[7] * y1 + F[8];
    const float a2 = F[0] * x2 + F[3] * y2 + F[6];
    const float b2 = F[1] * x2 + F[4] * y2 + F[7];
    const float e = a * x2 + b * y2 + c;
    in_second[i] = e * e / (a * a + b * b);
    in_first[i] = e * e / (a2 * a2 + b2 * b2);
  }
}

/// Symmetric transfer error of x2 ~ H x1 on pixels.
class HomographyErrors {
 public:
  HomographyErrors(const Intrinsics& camera, const Eigen::Matrix3d& H) {
    const Eigen::Matrix3d K = cameraMatrix(camera);
    const Eigen::Matrix3d on_pixels = K * H * K.inverse();
    H_second_first_ = on_pixels.cast<float>();
    H_first_second_ = on_pixels.inverse().cast<float>();
  }
  void operator()(const MatchBlock& m, TransferErrors& e) const {
    transferDistances(H_second_first_.data(), m.first_x, m.first_y, m.second_x, m.second_y, m.count,
                      e.in_second.data());
    transferDistances(H_first_second_.data(), m.second_x, m.second_y, m.first_x, m.first_y, m.count,
                      e.in_first.data());
  }

 private:
  RowMajor3f H_second_first_, H_first_second_;
};

/// Distances to the epipolar lines, on pixels.
class EpipolarErrors {
 public:
  EpipolarErrors(const Intrinsics& camera, const Eigen::Matrix3d& E) {
    const Eigen::Matrix3d K_inv = cameraMatrix(camera).inverse();
    F_ = (K_inv.transpose() * E * K_inv).normalized().cast<float>();
  }
  void operator()(const MatchBlock& m, TransferErrors& e) const {
    epipolarDistances(F_.data(), m, e.in_second.data(), e.in_first.data());
  }

 private:
  RowMajor3f F_;
};

/// What is left of `whole` after errors below `threshold` [px^2], summed, and how many matches have
/// both below it.
struct Left {
  float sum = 0;
  int inliers = 0;
};

DEPTHSCOPE_CLONES
Left whatIsLeft(const TransferErrors& e, float threshold, float whole) {
  std::array<float, kLanes> sum{};
  std::array<int, kLanes> inliers{};
  for (int i = 0; i < kBlock; i += kLanes)
    for (int lane = 0; lane < kLanes; ++lane) {
      const float e1 = e.in_second[i + lane], e2 = e.in_first[i + lane];
      sum[lane] += (e1 < threshold ? whole - e1 : 0) + (e2 < threshold ? whole - e2 : 0);
      inliers[lane] += (e1 < threshold) & (e2 < threshold);
    }
  Left left;
  for (int lane = 0; lane < kLanes; ++lane) {
    left.sum += sum[lane];
    left.inliers += inliers[lane];
  }
  return left;
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
  for (int i = 0; i < m.size(); i += kBlock) {
    if (model.score + 2 * kChi2TwoDof95 * (m.size() - i) <= to_beat) return;
    TransferErrors e;
    const MatchBlock block = blockAt(m, i);
    if (block.count < kBlock) {
      e.in_second.fill(std::numeric_limits<float>::infinity());
      e.in_first.fill(std::numeric_limits<float>::infinity());
    }
    errors(block, e);
    const Left left = whatIsLeft(e, static_cast<float>(threshold * sigma2),
                                 static_cast<float>(kChi2TwoDof95 * sigma2));
    model.score += left.sum / sigma2;
    model.inliers += left.inliers;
  }
}

/// Calls use(match, squared error in the second view, in the first [px^2]) for every match.
template <class Errors, class Use>
void forEachError(const TwoViewMatches& m, const Errors& errors, const Use& use) {
  TransferErrors e;
  for (int i = 0; i < m.size(); i += kBlock) {
    const MatchBlock block = blockAt(m, i);
    errors(block, e);
    for (int k = 0; k < block.count; ++k) use(i + k, e.in_second[k], e.in_first[k]);
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
