#include "slam/pnp.hpp"

#include <gtest/gtest.h>

#include "slam/p3p.hpp"
#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_scene.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

Pose randomPose(std::mt19937& rng) {
  return cameraAt({uniform(rng, -2, 2), uniform(rng, -2, 2), uniform(rng, -2, 2)},
                  {uniform(rng, -2, 2), uniform(rng, -2, 2), uniform(rng, -2, 2)});
}

TEST(P3p, findsTheTruthAmongItsSolutions) {
  std::mt19937 rng(1);
  int found = 0;
  constexpr int kTrials = 1000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Pose truth = randomPose(rng);
    std::array<Eigen::Vector3d, 3> bearings, points;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d p =
          uniform(rng, 1, 9) * testCamera().normalize(randomPixel(rng)).homogeneous();
      bearings[i] = p.normalized();
      points[i] = truth.inverse() * p;
    }
    std::array<Pose, 4> poses;
    const int count = solveP3p(bearings, points, poses);
    bool hit = false;
    for (int k = 0; k < count; ++k) {
      hit = hit || (rotationError(poses[k], truth) < 1e-5 && (poses[k].t - truth.t).norm() < 1e-4);
      for (int i = 0; i < 3; ++i)
        EXPECT_LT((poses[k] * points[i]).normalized().cross(bearings[i]).norm(), 1e-6);
    }
    found += hit;
  }
  EXPECT_GE(found, kTrials * 0.99);
}

TEST(P3p, hasNoAnswerForPointsInALine) {
  const std::array<Eigen::Vector3d, 3> points{Eigen::Vector3d(0, 0, 4), Eigen::Vector3d(0, 0, 4),
                                              Eigen::Vector3d(1, 0, 4)};
  const std::array<Eigen::Vector3d, 3> bearings{points[0].normalized(), points[1].normalized(),
                                                points[2].normalized()};
  std::array<Pose, 4> poses;
  EXPECT_EQ(solveP3p(bearings, points, poses), 0);
}

std::vector<PoseObservation> observe(const Pose& truth, int n, int outliers, double sigma_px) {
  std::mt19937 rng(5);
  std::vector<PoseObservation> observations(n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d pixel = randomPixel(rng);
    observations[i].point_world =
        truth.inverse() * (uniform(rng, 3, 6) * testCamera().normalize(pixel).homogeneous());
    observations[i].pixel = i < outliers ? randomPixel(rng) : pixel + gaussian2(rng, sigma_px);
    observations[i].inv_sigma2 = 1 / (sigma_px * sigma_px);
  }
  return observations;
}

TEST(Pnp, findsThePoseAmongHalfOutliers) {
  std::mt19937 rng(9);
  PnpSolver solver({}, 200);
  for (int trial = 0; trial < 20; ++trial) {
    const Pose truth = randomPose(rng);
    auto observations = observe(truth, 120, 60, 0.7);
    PnpResult result;
    ASSERT_TRUE(solver.solve(testCamera(), observations, result));
    EXPECT_LT(rotationError(result.T_camera_world, truth), 3e-3);
    EXPECT_LT((result.T_camera_world.t - truth.t).norm(), 2e-2);
    EXPECT_GE(result.inliers, 50);
    int wrong = 0;
    for (int i = 0; i < 60; ++i) wrong += observations[i].inlier;
    EXPECT_LE(wrong, 2);
  }
}

TEST(Pnp, findsThePoseOnAPlane) {
  const Pose truth = cameraAt({0.3, 0.2, -0.1}, {0.1, 0.2, 0.3});
  auto observations = observe(truth, 100, 30, 0.5);
  for (auto& o : observations) {
    const Eigen::Vector3d p = truth * o.point_world;
    o.point_world =
        truth.inverse() * (4 / Eigen::Vector3d(0.3, 0.1, 1).dot(p / p.z()) * (p / p.z()));
  }
  PnpSolver solver({}, 200);
  PnpResult result;
  ASSERT_TRUE(solver.solve(testCamera(), observations, result));
  EXPECT_LT(rotationError(result.T_camera_world, truth), 3e-3);
}

TEST(Pnp, refusesWhenNothingAgrees) {
  auto observations = observe({}, 150, 150, 1);
  PnpSolver solver({}, 200);
  PnpResult result;
  EXPECT_FALSE(solver.solve(testCamera(), observations, result));
  for (const auto& o : observations) EXPECT_FALSE(o.inlier);
  std::span<PoseObservation> none;
  EXPECT_FALSE(solver.solve(testCamera(), none, result));
}

TEST(Pnp, givesTheSameBitsTwiceAndAllocatesNothing) {
  const Pose truth = cameraAt({0.3, 0.2, -0.1}, {0.1, 0.2, 0.3});
  PnpSolver solver({}, 100);
  auto a = observe(truth, 130, 50, 1), b = a;  // more matches than it has room for
  PnpResult result_a, result_b;
  takeAllocationCount();
  {
    const AllocationScope scope;
    ASSERT_TRUE(solver.solve(testCamera(), a, result_a));
    ASSERT_TRUE(solver.solve(testCamera(), b, result_b));
  }
  EXPECT_EQ(takeAllocationCount(), 0);
  EXPECT_EQ(result_a.T_camera_world.R, result_b.T_camera_world.R);
  EXPECT_EQ(result_a.T_camera_world.t, result_b.T_camera_world.t);
  for (int i = 100; i < 130; ++i) EXPECT_FALSE(a[i].inlier);
}

}  // namespace
}  // namespace depthscope::slam
