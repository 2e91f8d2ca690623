#include "slam/two_view.hpp"

#include <gtest/gtest.h>

#include "slam/epipolar_refinement.hpp"
#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/projection.hpp"
#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/jacobian_check.hpp"
#include "tests/slam/synthetic_scene.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;
using Refusal = TwoViewResult::Refusal;

constexpr int kMatches = 400;
const Eigen::Vector3d kTilted = Eigen::Vector3d(0.3, -0.2, 1).normalized();

struct Matches {
  std::vector<Eigen::Vector2f> first, second;
  std::vector<std::uint8_t> correct;
};

/// Projections of points (first camera's frame) into both views, of which a share is replaced by
/// nonsense.
Matches project(const std::vector<Eigen::Vector3d>& points, const Pose& T_second_first,
                double noise_px, double outlier_share, unsigned seed) {
  std::mt19937 rng(seed);
  Matches m;
  for (const auto& p : points) {
    const bool outlier = uniform(rng, 0, 1) < outlier_share;
    const Eigen::Vector2d a = testCamera().project(p) + gaussian2(rng, noise_px);
    const Eigen::Vector2d b =
        outlier
            ? randomPixel(rng)
            : Eigen::Vector2d(testCamera().project(T_second_first * p) + gaussian2(rng, noise_px));
    m.first.push_back(a.cast<float>());
    m.second.push_back(b.cast<float>());
    m.correct.push_back(!outlier);
  }
  return m;
}

TwoViewInitializer initializer(const TwoViewSettings& settings = {}) {
  return {settings, testCamera(), 1000};
}

/// Direction of the translation and rotation, in degrees off the truth.
void expectMotion(const TwoViewResult& r, const Pose& truth, double rotation_deg,
                  double direction_deg) {
  EXPECT_LT(rotationError(r.T_second_first, truth) / kRadians, rotation_deg);
  const double cosine = r.T_second_first.t.dot(truth.t.normalized());
  EXPECT_LT(std::acos(std::min(1.0, cosine)) / kRadians, direction_deg);
  EXPECT_NEAR(r.T_second_first.t.norm(), 1, 1e-12);
}

/// Median over the points of the error in depth, as a share, after the one scale that is free.
double medianDepthError(const TwoViewResult& r, const std::vector<Eigen::Vector3d>& truth,
                        const Pose& T_second_first) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (r.triangulated[i])
      errors.push_back(std::abs(r.points[i].z() * T_second_first.t.norm() / truth[i].z() - 1));
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  return errors[errors.size() / 2];
}

TEST(TwoView, reconstructsAGeneralScene) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.4, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r)) << static_cast<int>(r.refusal);
  EXPECT_EQ(r.model, TwoViewResult::Model::Essential);
  expectMotion(r, truth, 0.2, 2);
  EXPECT_LT(medianDepthError(r, points, truth), 0.02);
  EXPECT_GT(r.inliers, 220);
  EXPECT_GT(r.median_parallax_deg, 3);
}

TEST(TwoView, reconstructsAPlanarScene) {
  const auto points = planePoints(kMatches, 1, kTilted, 5);
  const Pose truth = cameraAt({0.5, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r)) << static_cast<int>(r.refusal);
  EXPECT_EQ(r.model, TwoViewResult::Model::Homography);
  expectMotion(r, truth, 0.5, 4);
  EXPECT_LT(medianDepthError(r, points, truth), 0.04);
}

TEST(TwoView, refusesAPlaneSeenInMotionAlongTheAxisAsAmbiguous) {
  // Two motions and two planes give the same picture, and both are in front of both cameras.
  const auto points = planePoints(kMatches, 1, kTilted, 5);
  const Pose truth = cameraAt({0.1, 0.05, 0.7}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  EXPECT_FALSE(initializer().reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::Ambiguous);
}

TEST(TwoView, reconstructsFromMotionAlongTheOpticalAxis) {
  const auto points = volumePoints(kMatches, 3, 2, 5);
  const Pose truth = cameraAt({0.02, 0.05, 0.5}, {0.01, 0.02, 0.05});
  const Matches m = project(points, truth, 0.5, 0.2, 4);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r)) << static_cast<int>(r.refusal);
  expectMotion(r, truth, 0.3, 3);
}

TEST(TwoView, reconstructsFromLittleParallaxWhenAllowedTo) {
  // A scope near tissue after a few frames: 3 % of the depth, on a scene with some relief.
  const auto points = volumePoints(kMatches, 5, 4, 6);
  const Pose truth = cameraAt({0.14, 0.05, 0.02}, {0.01, -0.01, 0.02});
  const Matches m = project(points, truth, 0.3, 0.3, 6);
  TwoViewSettings settings;
  settings.min_parallax_deg = 0.8;
  TwoViewResult r;
  ASSERT_TRUE(initializer(settings).reconstruct(m.first, m.second, r))
      << static_cast<int>(r.refusal);
  expectMotion(r, truth, 0.3, 10);
  EXPECT_LT(medianDepthError(r, points, truth), 0.1);
}

TEST(TwoView, refusesPureRotation) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto points = volumePoints(kMatches, seed, 3, 7);
    const Pose truth = cameraAt({0, 0, 0}, {0.05 * std::cos(seed), 0.05 * std::sin(seed), 0.02});
    const Matches m = project(points, truth, 1, 0.3, 20 + seed);
    TwoViewResult r;
    EXPECT_FALSE(initializer().reconstruct(m.first, m.second, r));
    EXPECT_EQ(r.refusal, Refusal::RotationOnly);
  }
}

TEST(TwoView, refusesACameraThatStandsStill) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto points =
        seed % 2 ? volumePoints(kMatches, seed, 3, 7) : planePoints(kMatches, seed, kTilted, 5);
    const double outliers = seed % 3 ? 0.3 : 0;
    const Matches m = project(points, Pose{}, 1, outliers, 40 + seed);
    TwoViewResult r;
    EXPECT_FALSE(initializer().reconstruct(m.first, m.second, r));
    EXPECT_EQ(r.refusal, Refusal::RotationOnly);
  }
}

TEST(TwoView, refusesTooLittleParallax) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.2, 0, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.3, 0.1, 2);
  TwoViewSettings settings;
  settings.min_parallax_deg = 5;
  TwoViewResult r;
  EXPECT_FALSE(initializer(settings).reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::LowParallax);
}

TEST(TwoView, refusesAMotionWhoseDirectionIsHardlyDetermined) {
  const auto points = planePoints(60, 1, kTilted, 5);
  const Pose truth = cameraAt({0.2, 0.05, 0}, {0.01, -0.01, 0.02});
  const Matches m = project(points, truth, 1, 0, 2);
  TwoViewSettings settings;
  settings.min_inliers = 30;
  settings.max_rotation_share = 1;
  TwoViewResult r;
  EXPECT_FALSE(initializer(settings).reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::Uncertain);
}

TEST(TwoView, refusesNonsenseAndTooFewMatches) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  TwoViewResult r;
  const Matches nonsense = project(points, Pose{}, 1, 1, 3);
  EXPECT_FALSE(initializer().reconstruct(nonsense.first, nonsense.second, r));
  const Matches few = project(volumePoints(30, 1, 3, 7), cameraAt({1, 0, 0}, {0, 0, 0}), 0, 0, 3);
  EXPECT_FALSE(initializer().reconstruct(few.first, few.second, r));
  EXPECT_EQ(r.refusal, Refusal::TooFewMatches);
  EXPECT_FALSE(initializer().reconstruct({}, {}, r));
  EXPECT_EQ(r.points.size(), 0u);
}

TEST(TwoView, refusesMatchesThatAreAllTheSame) {
  const std::vector<Eigen::Vector2f> first(200, {100, 100}), second(200, {160, 120});
  TwoViewResult r;
  EXPECT_FALSE(initializer().reconstruct(first, second, r));
}

TEST(TwoView, marksWrongMatches) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.5, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r));
  int wrong = 0;
  for (int i = 0; i < kMatches; ++i) wrong += !m.correct[i] && r.triangulated[i];
  EXPECT_LE(wrong, r.inliers / 30) << "a wrong match may lie on its epipolar line by chance";
}

TEST(TwoView, givesTheSameBitsTwiceAndAllocatesNothing) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Matches m = project(points, cameraAt({0.5, 0.1, 0.05}, {0.02, -0.05, 0.03}), 0.5, 0.3, 2);
  auto two_view = initializer();
  TwoViewResult a, b;
  ASSERT_TRUE(two_view.reconstruct(m.first, m.second, a));
  b = a;
  takeAllocationCount();
  {
    const AllocationScope scope;
    ASSERT_TRUE(two_view.reconstruct(m.first, m.second, b));
  }
  EXPECT_EQ(takeAllocationCount(), 0);
  EXPECT_EQ(a.T_second_first.R, b.T_second_first.R);
  EXPECT_EQ(a.T_second_first.t, b.T_second_first.t);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangulated, b.triangulated);
}

TEST(Homography, decompositionContainsTheMotion) {
  std::mt19937 rng(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Pose truth = cameraAt({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)},
                                {uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)});
    const Eigen::Matrix3d H = truth.R + truth.t * kTilted.transpose() / 3;
    std::array<Pose, 8> motions;
    const int count = decomposeHomography((trial % 2 ? -2.5 : 1.7) * H, motions);
    ASSERT_EQ(count, 8);
    double best = 1;
    for (const Pose& p : motions) {
      EXPECT_NEAR(p.R.determinant(), 1, 1e-9);
      EXPECT_TRUE((p.R * p.R.transpose()).isIdentity(1e-9));
      best = std::min(best, (p.R - truth.R).norm() + (p.t - truth.t.normalized()).norm());
    }
    EXPECT_LT(best, 1e-6);
  }
}

TEST(Homography, ofARotationSaysNothingAboutTranslation) {
  std::array<Pose, 8> motions;
  EXPECT_EQ(decomposeHomography(3 * expSO3({0.1, 0.2, -0.1}), motions), 0);
}

TEST(Homography, fitsFourPointsAndMany) {
  Eigen::Matrix3d truth;
  truth << 1.1, 0.02, 0.1, -0.03, 0.95, -0.05, 0.04, 0.02, 1;
  truth /= truth.norm();
  std::mt19937 rng(2);
  for (const int n : {4, 30}) {
    std::vector<Eigen::Vector2d> first, second;
    for (int i = 0; i < n; ++i) {
      first.push_back(testCamera().normalize(randomPixel(rng)));
      second.push_back((truth * first.back().homogeneous()).hnormalized());
    }
    Eigen::Matrix3d H;
    ASSERT_TRUE(fitHomography(first, second, H));
    EXPECT_LT(std::min((H - truth).norm(), (H + truth).norm()), 1e-9);
  }
}

TEST(Essential, fivePointsFindTheTruthInGeneralAndPlanarScenes) {
  std::mt19937 rng(3);
  constexpr int kTrials = 200;
  int found = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Pose truth =
        cameraAt({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)},
                 {uniform(rng, -.3, .3), uniform(rng, -.3, .3), uniform(rng, -.3, .3)});
    const auto points =
        trial % 2 ? volumePoints(5, trial, 3, 8) : planePoints(5, trial, kTilted, 5);
    std::array<Eigen::Vector2d, 5> first, second;
    for (int i = 0; i < 5; ++i) {
      first[i] = points[i].hnormalized();
      second[i] = (truth * points[i]).hnormalized();
    }
    const Eigen::Matrix3d E_truth = skew(truth.t.normalized()) * truth.R;
    std::array<Eigen::Matrix3d, 10> E;
    const int count = solveEssentialFivePoint(first, second, E);
    double best = 1;
    for (int k = 0; k < count; ++k)
      best = std::min({best, (E[k] - E_truth).norm(), (E[k] + E_truth).norm()});
    found += best < 1e-5;
  }
  EXPECT_GE(found, kTrials * 0.97);
}

TEST(Essential, decompositionContainsTheMotion) {
  const Pose truth = cameraAt({0.5, -0.3, 0.2}, {0.2, -0.1, 0.3});
  std::array<Pose, 4> motions;
  decomposeEssential(-3 * skew(truth.t) * truth.R, motions);
  double best = 1;
  for (const Pose& p : motions) {
    EXPECT_NEAR(p.R.determinant(), 1, 1e-9);
    best = std::min(best, (p.R - truth.R).norm() + (p.t - truth.t.normalized()).norm());
  }
  EXPECT_LT(best, 1e-9);
}

TEST(EpipolarRefinement, jacobianOfTheResidual) {
  const Pose pose = cameraAt({0.5, -0.3, 0.2}, {0.2, -0.1, 0.3});
  const Eigen::Vector2d first(0.2, -0.1), second(-0.3, 0.25);
  EXPECT_TRUE((jacobianMatches<1, 6>(epipolarJacobian(pose, first, second), [&](const Vector6d& d) {
    const Pose moved{expSO3(d.head<3>()) * pose.R, pose.t + d.tail<3>()};
    return Eigen::Matrix<double, 1, 1>(epipolarResidual(moved, first, second));
  })));
}

TEST(EpipolarRefinement, comesBackToTheTruth) {
  Pose truth = cameraAt({0.5, -0.3, 0.2}, {0.05, -0.1, 0.1});
  truth.t.normalize();
  const Matches m = project(volumePoints(100, 1, 3, 7), truth, 0, 0, 1);
  TwoViewMatches matches(testCamera(), 100);
  matches.load(m.first, m.second);
  Pose pose = truth.retract({0.03, -0.02, 0.02}, {0.1, 0.05, -0.1});
  pose.t.normalize();
  const double sigma = refineEpipolarGeometry(matches, m.correct, 1, 20, pose);
  EXPECT_LT(rotationError(pose, truth), 1e-5) << "pixels are rounded to float";
  EXPECT_LT((pose.t - truth.t).norm(), 1e-5);
  EXPECT_GT(sigma, 0);
  EXPECT_LT(sigma, 0.1);
}

TEST(EpipolarRefinement, foretellsTheSpreadOfTheDirection) {
  Pose truth = cameraAt({0.5, -0.3, 0.2}, {0.05, -0.1, 0.1});
  truth.t.normalize();
  constexpr int kTrials = 200;
  double sum = 0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const Matches m = project(volumePoints(100, trial, 3, 7), truth, 0.5, 0, trial + 1000);
    TwoViewMatches matches(testCamera(), 100);
    matches.load(m.first, m.second);
    Pose pose = truth;
    const double sigma = refineEpipolarGeometry(matches, m.correct, 0.5, 20, pose);
    sum += (pose.t - truth.t).squaredNorm() / (sigma * sigma);
  }
  EXPECT_NEAR(sum / kTrials, 1, 0.3);
}

}  // namespace
}  // namespace depthscope::slam
