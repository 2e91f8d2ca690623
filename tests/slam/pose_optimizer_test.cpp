#include "slam/pose_optimizer.hpp"

#include <gtest/gtest.h>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_scene.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

const Pose kTruth = cameraAt({0.2, -0.1, 0.3}, {0.05, -0.1, 0.02});
const Pose kStart = cameraAt({0.1, 0.0, 0.1}, {0.0, -0.05, 0.05});

std::vector<PoseObservation> observe(int n, double sigma_px, unsigned seed) {
  std::mt19937 rng(seed);
  std::vector<PoseObservation> observations;
  for (const auto& p : volumePoints(n, seed + 1, 3, 8)) {
    PoseObservation o;
    o.point_world = p;
    o.pixel = testCamera().project(kTruth * p) + gaussian2(rng, sigma_px);
    o.inv_sigma2 = sigma_px > 0 ? 1 / (sigma_px * sigma_px) : 1;
    observations.push_back(o);
  }
  return observations;
}

TEST(PoseOptimizer, findsThePoseExactlyWithoutNoise) {
  auto observations = observe(100, 0, 1);
  Pose pose = kStart;
  const auto result = optimizePose(testCamera(), observations, pose);
  ASSERT_TRUE(result.ok);
  EXPECT_EQ(result.inliers, 100);
  EXPECT_LT(rotationError(pose, kTruth), 1e-9);
  EXPECT_LT((pose.t - kTruth.t).norm(), 1e-9);
}

TEST(PoseOptimizer, tellsOutliersFromInliers) {
  auto observations = observe(300, 0.5, 2);
  std::mt19937 rng(3);
  for (int i = 0; i < 120; ++i) observations[i].pixel = randomPixel(rng);
  Pose pose = kStart;
  const auto result = optimizePose(testCamera(), observations, pose);
  ASSERT_TRUE(result.ok);
  EXPECT_LT(rotationError(pose, kTruth), 1e-3);
  EXPECT_LT((pose.t - kTruth.t).norm(), 5e-3);
  int wrong_in = 0, right_in = 0;
  for (int i = 0; i < 300; ++i) (i < 120 ? wrong_in : right_in) += observations[i].inlier;
  EXPECT_LE(wrong_in, 2);
  EXPECT_GE(right_in, 160) << "about 5 % of the good ones lie beyond the 95 % threshold";
  EXPECT_EQ(result.inliers, wrong_in + right_in);
}

TEST(PoseOptimizer, anObservationTrustedLessPullsLess) {
  auto observations = observe(60, 0, 4);
  for (int i = 0; i < 30; ++i) observations[i].pixel.x() += 2;  // half of the tissue has moved
  const auto pull = [&](double weight) {
    for (int i = 0; i < 30; ++i) observations[i].weight = weight;
    for (auto& o : observations) o.inlier = true;
    Pose pose = kTruth;
    EXPECT_TRUE(optimizePose(testCamera(), observations, pose).ok);
    return (pose.t - kTruth.t).norm() + rotationError(pose, kTruth);
  };
  EXPECT_LT(pull(0.01), 0.2 * pull(1));
}

TEST(PoseOptimizer, covarianceForetellsTheSpreadOfTheErrors) {
  // The normalized squared error of n trials has 6 n degrees of freedom: mean 6, deviation
  // sqrt(12 / n). Inliers alone are kept, so the errors are a little smaller than those of the
  // noise.
  constexpr int kTrials = 200;
  double sum = 0, rms = 0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    auto observations = observe(80, 1, 100 + trial);
    Pose pose = kTruth;
    const auto result = optimizePose(testCamera(), observations, pose);
    ASSERT_TRUE(result.ok);
    const Pose error = pose * kTruth.inverse();
    Vector6d e;
    e << logSO3(error.R), error.t;
    sum += e.dot(result.covariance.inverse() * e);
    rms += result.rms_px;
  }
  EXPECT_NEAR(sum / kTrials, 6, 1.2);
  // sqrt(1.68), two Gaussian errors cut off at the 95 % threshold, less what six unknowns absorb.
  EXPECT_NEAR(rms / kTrials, 1.27, 0.03);
}

TEST(PoseOptimizer, refusesTooFewObservationsAndLeavesThePose) {
  auto observations = observe(5, 0, 5);
  Pose pose = kStart;
  EXPECT_FALSE(optimizePose(testCamera(), observations, pose).ok);
  EXPECT_EQ(pose.R, kStart.R);
  EXPECT_EQ(pose.t, kStart.t);
  std::span<PoseObservation> none;
  EXPECT_FALSE(optimizePose(testCamera(), none, pose).ok);
}

TEST(PoseOptimizer, refusesCoincidentPoints) {
  auto observations = observe(50, 0, 6);
  for (auto& o : observations) o = observations[0];
  Pose pose = kTruth;
  EXPECT_FALSE(optimizePose(testCamera(), observations, pose).ok);
}

TEST(PoseOptimizer, survivesPointsBehindTheCameraAndNonFiniteOnes) {
  auto observations = observe(100, 0, 7);
  observations[3].point_world = kTruth.inverse() * Eigen::Vector3d(0.1, 0.1, -2);
  observations[4].point_world.setConstant(std::nan(""));
  Pose pose = kStart;
  const auto result = optimizePose(testCamera(), observations, pose);
  ASSERT_TRUE(result.ok);
  EXPECT_FALSE(observations[3].inlier);
  EXPECT_FALSE(observations[4].inlier);
  EXPECT_LT(rotationError(pose, kTruth), 1e-9);
}

TEST(PoseOptimizer, allocatesNothing) {
  auto observations = observe(300, 1, 8);
  Pose pose = kStart;
  takeAllocationCount();
  {
    const AllocationScope scope;
    optimizePose(testCamera(), observations, pose);
  }
  EXPECT_EQ(takeAllocationCount(), 0);
}

}  // namespace
}  // namespace depthscope::slam
