#include "slam/two_view_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "slam/epipolar_refinement.hpp"
#include "slam/essential.hpp"
#include "slam/homography.hpp"
#include "slam/polynomial_roots.hpp"
#include "slam/projection.hpp"
#include "slam/transfer_errors.hpp"
#include "tests/slam/jacobian_check.hpp"
#include "tests/slam/synthetic_scene.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

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

/// Block by block against the definition, the last block not full.
TEST(TransferErrors, areDistancesOnPixelsInBothViews) {
  const Intrinsics camera = testCamera();
  const Pose truth = cameraAt({0.4, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(volumePoints(TransferErrors::block + 5, 1, 3, 7), truth, 0.5, 0.3, 2);
  TwoViewMatches matches(camera, 100);
  matches.load(m.first, m.second);
  const Eigen::Matrix3d E = skew(truth.t) * truth.R;
  const auto to_line2 = [&](const Eigen::Vector3d& line, const Eigen::Vector2d& x) {
    const double a = line.x() / camera.fx, b = line.y() / camera.fy;
    return std::pow(line.dot(x.homogeneous()), 2) / (a * a + b * b);
  };
  int seen = 0;
  forEachError(matches, EpipolarErrors(camera, E), [&](int i, float in_second, float in_first) {
    EXPECT_EQ(i, seen++);
    const Eigen::Vector2d &x1 = matches.first[i], &x2 = matches.second[i];
    const double second = to_line2(E * x1.homogeneous(), x2);
    const double first = to_line2(E.transpose() * x2.homogeneous(), x1);
    EXPECT_NEAR(in_second, second, 1e-3 * (1 + second));
    EXPECT_NEAR(in_first, first, 1e-3 * (1 + first));
  });
  EXPECT_EQ(seen, matches.size());

  TransferErrors errors;
  HomographyErrors(camera, truth.R)(matchBlock(matches, TransferErrors::block), errors);
  const Eigen::Vector2d moved =
      camera.project(truth.R * matches.first[TransferErrors::block].homogeneous());
  const double distance2 = (moved - matches.second_px[TransferErrors::block]).squaredNorm();
  EXPECT_NEAR(errors.in_second[0], distance2, 1e-3 * (1 + distance2));
  EXPECT_TRUE(std::isinf(errors.in_second[5]));

  errors.in_second.fill(7);
  errors.in_first.fill(3);
  errors.in_first[30] = 1;
  errors.in_second[30] = 2;
  const Left left = whatIsLeft(errors, 5, 6);
  EXPECT_EQ(left.inliers, 1);
  EXPECT_FLOAT_EQ(left.sum, 31 * (6 - 3) + (6 - 1) + (6 - 2));
}

/// Whether the motion is among those that five points, free of noise, leave possible.
bool fivePointsFind(const Pose& truth, const std::vector<Eigen::Vector3d>& points) {
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
  return best < 1e-5;
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
    found += fivePointsFind(truth, points);
  }
  EXPECT_GE(found, kTrials * 0.97);
}

/// Views this close make all translations without rotation look nearly right.
TEST(Essential, fivePointsFindTheTruthFromViewsThatHardlyDiffer) {
  std::mt19937 rng(4);
  constexpr int kTrials = 500;
  int found = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Pose truth = cameraAt({uniform(rng, -.02, .02), uniform(rng, -.02, .02), 0.01},
                                {uniform(rng, -.01, .01), uniform(rng, -.01, .01), 0.005});
    const auto points = volumePoints(5, trial, 3, 8);
    found += fivePointsFind(truth, points);
  }
  EXPECT_GE(found, kTrials * 0.99);
}

/// What is returned satisfies every constraint, whatever the five pairs are.
TEST(Essential, fivePointsGiveEssentialMatricesForNonsenseToo) {
  std::mt19937 rng(5);
  for (int trial = 0; trial < 500; ++trial) {
    std::array<Eigen::Vector2d, 5> first, second;
    for (int i = 0; i < 5; ++i) {
      first[i] = {uniform(rng, -1, 1), uniform(rng, -1, 1)};
      second[i] = {uniform(rng, -1, 1), uniform(rng, -1, 1)};
    }
    std::array<Eigen::Matrix3d, 10> solutions;
    const int count = solveEssentialFivePoint(first, second, solutions);
    for (int k = 0; k < count; ++k) {
      const Eigen::Matrix3d& E = solutions[k];
      EXPECT_NEAR(E.norm(), std::sqrt(2.0), 1e-9);
      const Eigen::Matrix3d EEt = E * E.transpose();
      EXPECT_LT((2 * EEt * E - EEt.trace() * E).norm(), 1e-6);
      for (int i = 0; i < 5; ++i)
        EXPECT_NEAR(second[i].homogeneous().dot(E * first[i].homogeneous()), 0, 1e-9);
    }
  }
}

/// Coefficients of (x - r) for all the real roots, and (x - a)^2 + b^2 for the complex ones.
DecicPolynomial polynomial(std::span<const double> real, std::span<const Eigen::Vector2d> complex) {
  DecicPolynomial f{};
  f[0] = -2;
  const auto timesLinear = [&f](double r) {
    for (int i = 10; i >= 0; --i) f[i] = (i > 0 ? f[i - 1] : 0) - r * f[i];
  };
  for (const double r : real) timesLinear(r);
  for (const Eigen::Vector2d& c : complex)
    for (int i = 10; i >= 0; --i)
      f[i] = (i > 1 ? f[i - 2] : 0) - 2 * c.x() * (i > 0 ? f[i - 1] : 0) + c.squaredNorm() * f[i];
  return f;
}

TEST(PolynomialRoots, areAllFoundAndNoOthers) {
  const std::vector<Eigen::Vector2d> complex{{0.3, 0.2}, {-5, 1}, {0.01, 2}, {30, 3}, {0, 0.5}};
  const std::vector<double> real{0.1, -0.7, 0.1001, 1.5, -20, -0.3, 3000, -1.1, 0.9, 7};
  for (int count = 0; count <= 10; count += 2) {
    std::vector<double> expected(real.begin(), real.begin() + count);
    const auto f = polynomial(expected, std::span(complex).first(5 - count / 2));
    std::array<double, 10> found;
    ASSERT_EQ(realRoots(f, found), count);
    std::vector<double> roots(found.begin(), found.begin() + count);
    std::sort(expected.begin(), expected.end());
    std::sort(roots.begin(), roots.end());
    for (int i = 0; i < count; ++i)
      EXPECT_NEAR(roots[i], expected[i], 1e-6 * (1 + std::abs(expected[i])));
  }
}

TEST(PolynomialRoots, noneWithoutAPolynomialOfDegreeTen) {
  std::array<double, 10> roots;
  EXPECT_EQ(realRoots({}, roots), 0);
  DecicPolynomial f{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  f[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(realRoots(f, roots), 0);
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

/// Drawing ends early where most matches are right: with half of them wrong it must not.
TEST(TwoViewModelFinder, drawsUntilASampleIsFreeOfWrongMatches) {
  Pose truth = cameraAt({0.5, -0.3, 0.2}, {0.05, -0.1, 0.1});
  for (const double wrong : {0.0, 0.3, 0.5}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const Matches m = project(volumePoints(200, seed, 3, 7), truth, 0.3, wrong, seed);
      TwoViewMatches matches(testCamera(), 200);
      matches.load(m.first, m.second);
      TwoViewModel homography, essential;
      TwoViewModelFinder(200).find(matches, 0.5, 400, homography, essential);
      const auto right = std::count(m.correct.begin(), m.correct.end(), 1);
      EXPECT_GT(essential.inliers, 0.75 * static_cast<double>(right)) << wrong << " " << seed;
    }
  }
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
