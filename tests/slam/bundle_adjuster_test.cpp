#include "slam/bundle_adjuster.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_scene.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

constexpr int kPoses = 8, kPoints = 200;

/// Cameras on an arc, all looking at the same volume; the first two are fixed.
struct Scene {
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points = volumePoints(kPoints, 1, 4, 8);

  Scene() {
    for (int i = 0; i < kPoses; ++i)
      poses.push_back(
          cameraAt({0.25 * i, 0.05 * i * (i - 4), 0.02 * i}, {0.01 * i, -0.03 * i, 0.02 * i}));
  }

  /// Fills `ba` with exact observations plus noise, and with poses and points off the truth.
  void load(BundleAdjuster& ba, double noise_px, double pose_error, double point_error) const {
    std::mt19937 rng(7);
    const auto error = [&](double size) {
      return Eigen::Vector3d(uniform(rng, -size, size), uniform(rng, -size, size),
                             uniform(rng, -size, size));
    };
    ba.clear();
    for (int i = 0; i < kPoses; ++i) {
      const bool fixed = i < 2;
      ba.addPose(fixed ? poses[i] : poses[i].retract(error(pose_error), error(pose_error)), fixed);
    }
    for (const auto& p : points) ba.addPoint(p + error(point_error));
    for (int p = 0; p < kPoints; ++p)
      for (int c = 0; c < kPoses; ++c) {
        BaObservation o;
        o.pose = c;
        o.point = p;
        o.pixel =
            (testCamera().project(poses[c] * points[p]) + gaussian2(rng, noise_px)).cast<float>();
        ba.addObservation(o);
      }
  }
};

double worstPointError(BundleAdjuster& ba, const Scene& scene) {
  double worst = 0;
  for (int p = 0; p < kPoints; ++p)
    worst = std::max(worst, (ba.points()[p] - scene.points[p]).norm());
  return worst;
}

double worstPoseError(BundleAdjuster& ba, const Scene& scene) {
  double worst = 0;
  for (int i = 0; i < kPoses; ++i) {
    const Pose& found = ba.poses()[i].T_camera_world;
    worst = std::max(
        {worst, rotationError(found, scene.poses[i]), (found.t - scene.poses[i].t).norm()});
  }
  return worst;
}

/// Pixels are rounded to float: 2^-15 px at 512 px and more.
constexpr double kFloatPixel = 3e-5;

TEST(BundleAdjuster, comesBackToTheTruthFromAFarStart) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  scene.load(ba, 0, 0.05, 0.3);
  BaSettings settings;
  settings.max_iterations = 30;
  const BaSummary summary = ba.solve(testCamera(), settings);
  EXPECT_LT(worstPoseError(ba, scene), 1e-6);
  EXPECT_LT(worstPointError(ba, scene), 1e-5) << "pixels are rounded to float";
  EXPECT_LT(summary.rms_px, kFloatPixel);
  EXPECT_EQ(summary.outliers, 0);
  EXPECT_EQ(summary.end, BaSummary::End::Converged);
}

TEST(BundleAdjuster, leavesFixedPosesAlone) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  scene.load(ba, 1, 0.02, 0.1);
  ba.solve(testCamera());
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(ba.poses()[i].T_camera_world.R, scene.poses[i].R);
    EXPECT_EQ(ba.poses()[i].T_camera_world.t, scene.poses[i].t);
  }
}

TEST(BundleAdjuster, residualsHaveTheVarianceOfTheNoise) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  scene.load(ba, 0.5, 0.02, 0.1);
  BaSettings settings;
  settings.max_iterations = 20;
  const BaSummary summary = ba.solve(testCamera(), settings);
  const double equations = 2.0 * kPoses * kPoints, unknowns = 3.0 * kPoints + 6 * (kPoses - 2);
  const double variance =
      summary.rms_px * summary.rms_px * (kPoses * kPoints) / (equations - unknowns);
  EXPECT_NEAR(std::sqrt(variance), 0.5, 0.02);
  EXPECT_LT(worstPoseError(ba, scene), 0.01);
}

TEST(BundleAdjuster, flagsOutliersAndIsNotPulledByThem) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  scene.load(ba, 0.3, 0.02, 0.1);
  std::mt19937 rng(11);
  std::vector<std::uint8_t> spoilt(kPoses * kPoints, 0);
  for (int i = 0; i < kPoses * kPoints / 10; ++i) {
    const auto k = static_cast<std::size_t>(uniform(rng, 0, kPoses * kPoints));
    spoilt[k] = 1;
    ba.observations()[k].pixel += Eigen::Vector2f(40, i % 2 ? 30.f : -30.f);
  }
  ba.solve(testCamera());                            // under Huber's cost,
  const BaSummary summary = ba.solve(testCamera());  // then without what it found to be wrong
  int missed = 0, lost = 0, total = 0;
  for (std::size_t k = 0; k < spoilt.size(); ++k) {
    total += spoilt[k];
    missed += spoilt[k] && ba.observations()[k].inlier;
    lost += !spoilt[k] && !ba.observations()[k].inlier;
  }
  EXPECT_LE(missed, total / 50);
  EXPECT_LE(lost, kPoses * kPoints / 50);
  EXPECT_EQ(summary.outliers, total - missed + lost);
  EXPECT_LT(worstPoseError(ba, scene), 0.01);
}

/// Every observation is seen off by `off` times a shift that depends on camera and place, as a
/// rolling shutter's does.
void shiftObservations(BundleAdjuster& ba, double off) {
  std::mt19937 rng(23);
  std::vector<Eigen::Vector2d> motion(kPoses);
  for (auto& m : motion) m = {uniform(rng, -40, 40), uniform(rng, -40, 40)};
  for (BaObservation& o : ba.observations()) {
    o.shift = (motion[o.pose] * (o.pixel.y() / kHeight_px - 0.5)).cast<float>();
    o.pixel += static_cast<float>(off) * o.shift;
  }
}

TEST(BundleAdjuster, tellsHowFarASharedParameterIsOff) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  for (const double truth : {0.0, 0.1, -0.2}) {
    scene.load(ba, 0.3, 0.01, 0.05);
    shiftObservations(ba, truth);
    BaSettings settings;
    settings.max_iterations = 20;
    settings.chi2_inlier = 100;
    ba.solve(testCamera(), settings);
    const auto points = ba.points()[7];
    const auto shared = ba.estimateShared(testCamera(), settings);
    ASSERT_TRUE(shared);
    EXPECT_EQ(ba.points()[7], points) << "it adjusts nothing";
    // The noise is 0.3 px where sigma stands for one pixel.
    EXPECT_LT(shared->sigma, 0.01);
    EXPECT_NEAR(shared->offset, truth, 3 * 0.3 * shared->sigma + 0.02 * std::abs(truth));
  }
}

TEST(BundleAdjuster, saysNothingOfAParameterThatNothingDependsOn) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  EXPECT_FALSE(ba.estimateShared(testCamera())) << "there are no observations";
  scene.load(ba, 0.3, 0.01, 0.05);
  EXPECT_FALSE(ba.estimateShared(testCamera())) << "no observation is shifted";
}

TEST(BundleAdjuster, costNeverRises) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  scene.load(ba, 1, 0.2, 1.5);
  double last = INFINITY;
  for (int i = 0; i < 10; ++i) {
    BaSettings settings;
    settings.max_iterations = 1;
    for (auto& o : ba.observations()) o.inlier = true;
    const BaSummary summary = ba.solve(testCamera(), settings);
    EXPECT_LE(summary.final_cost, summary.initial_cost);
    EXPECT_LE(summary.initial_cost, last * (1 + 1e-12));
    last = summary.final_cost;
  }
}

TEST(BundleAdjuster, givesTheSameBitsTwice) {
  const Scene scene;
  BundleAdjuster a(kPoses, kPoints, kPoses * kPoints), b(20, 500, 9000);
  for (BundleAdjuster* ba : {&a, &b}) {
    scene.load(*ba, 1, 0.05, 0.3);
    ba->solve(testCamera());
  }
  for (int i = 0; i < kPoses; ++i) {
    EXPECT_EQ(a.poses()[i].T_camera_world.R, b.poses()[i].T_camera_world.R);
    EXPECT_EQ(a.poses()[i].T_camera_world.t, b.poses()[i].T_camera_world.t);
  }
  for (int p = 0; p < kPoints; ++p) EXPECT_EQ(a.points()[p], b.points()[p]);
}

TEST(BundleAdjuster, allocatesNothingAfterConstruction) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  takeAllocationCount();
  for (int round = 0; round < 2; ++round) {
    const AllocationScope scope;
    const Pose pose;
    ba.clear();
    for (int i = 0; i < kPoses; ++i) ba.addPose(scene.poses[i], i < 2);
    for (const auto& p : scene.points) ba.addPoint(p * 1.01);
    for (int p = 0; p < kPoints; ++p)
      for (int c = 0; c < kPoses; ++c)
        ba.addObservation(
            {c, p, testCamera().project(scene.poses[c] * scene.points[p]).cast<float>(), 1, true});
    ba.solve(testCamera());
  }
  EXPECT_EQ(takeAllocationCount(), 0);
}

TEST(BundleAdjuster, refusesWhatDoesNotFit) {
  BundleAdjuster ba(1, 1, 1);
  EXPECT_EQ(ba.addPose({}, true), 0);
  EXPECT_EQ(ba.addPose({}, true), -1);
  EXPECT_EQ(ba.addPoint({0, 0, 1}), 0);
  EXPECT_EQ(ba.addPoint({0, 0, 1}), -1);
  EXPECT_EQ(ba.addObservation({}), 0);
  EXPECT_EQ(ba.addObservation({}), -1);
}

TEST(BundleAdjuster, stopsWhenTold) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  scene.load(ba, 1, 0.05, 0.3);
  const Eigen::Vector3d before = ba.points()[0];
  const std::atomic<bool> stop = true;
  const BaSummary summary = ba.solve(testCamera(), {}, &stop);
  EXPECT_EQ(summary.end, BaSummary::End::Stopped);
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(ba.points()[0], before);
}

TEST(BundleAdjuster, survivesPointsBehindACameraAndLonelyOnes) {
  const Scene scene;
  BundleAdjuster ba(kPoses, kPoints + 2, kPoses * kPoints + 3);
  scene.load(ba, 0, 0.02, 0.1);
  const int behind = ba.addPoint({0, 0, -3}), lonely = ba.addPoint({0.2, 0.1, 5});
  ba.addObservation({2, behind, {300, 200}, 1, true});
  ba.addObservation({3, behind, {310, 200}, 1, true});
  ba.addObservation({4, lonely, {100, 100}, 1, true});
  BaSettings settings;
  settings.max_iterations = 30;
  ba.solve(testCamera(), settings);
  EXPECT_LT(worstPoseError(ba, scene), 1e-6);
  EXPECT_EQ(ba.points()[lonely], Eigen::Vector3d(0.2, 0.1, 5)) << "one ray does not move a point";
  EXPECT_FALSE(ba.observations()[kPoses * kPoints].inlier);
  EXPECT_FALSE(ba.observations()[kPoses * kPoints + 2].inlier);
}

TEST(BundleAdjuster, failsOnNothingAndOnNotANumber) {
  BundleAdjuster ba(kPoses, kPoints, kPoses * kPoints);
  EXPECT_EQ(ba.solve(testCamera()).end, BaSummary::End::Failed);
  const Scene scene;
  scene.load(ba, 0, 0.02, 0.1);
  ba.observations()[5].pixel.x() = std::nanf("");
  const Pose before = ba.poses()[3].T_camera_world;
  EXPECT_EQ(ba.solve(testCamera()).end, BaSummary::End::Failed);
  EXPECT_EQ(ba.poses()[3].T_camera_world.t, before.t);
}

TEST(BlockCholesky, solvesLikeADenseSolver) {
  constexpr int kBlocks = 5, kSize = 6 * kBlocks;
  std::mt19937 rng(3);
  Eigen::MatrixXd M(kSize, kSize);
  for (auto& m : M.reshaped()) m = uniform(rng, -1, 1);
  const Eigen::MatrixXd A = M * M.transpose() + 0.1 * Eigen::MatrixXd::Identity(kSize, kSize);
  Eigen::VectorXd b(kSize);
  for (auto& v : b) v = uniform(rng, -1, 1);

  BlockCholesky system(kBlocks + 2);
  system.reset(kBlocks);
  std::vector<Vector6d> x(kBlocks);
  for (int i = 0; i < kBlocks; ++i) {
    for (int j = 0; j <= i; ++j) system.block(i, j) = A.block<6, 6>(6 * i, 6 * j);
    x[i] = b.segment<6>(6 * i);
  }
  ASSERT_TRUE(system.factor());
  system.solve(x);
  const Eigen::VectorXd expected = A.ldlt().solve(b);
  for (int i = 0; i < kBlocks; ++i)
    EXPECT_LT((x[i] - expected.segment<6>(6 * i)).norm(), 1e-9 * expected.norm());
}

TEST(BlockCholesky, refusesAnIndefiniteMatrix) {
  BlockCholesky system(2);
  system.reset(2);
  system.block(0, 0).setIdentity();
  system.block(1, 1).setIdentity();
  system.block(1, 0) = 2 * Matrix6d::Identity();
  EXPECT_FALSE(system.factor());
}

}  // namespace
}  // namespace depthscope::slam
