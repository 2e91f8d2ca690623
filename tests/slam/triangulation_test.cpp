#include "slam/triangulation.hpp"

#include <gtest/gtest.h>

#include "tests/slam/synthetic_scene.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

Eigen::Vector2d normalized(const Pose& T_camera_world, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = T_camera_world * world;
  return p.head<2>() / p.z();
}

const Pose kA = cameraAt({0.1, 0.2, -0.3}, {0.05, 0.1, -0.2});
const Pose kB = cameraAt({0.4, 0.1, -0.2}, {-0.1, 0.02, 0.1});

TEST(Triangulation, findsThePointExactlyWithoutNoise) {
  for (const auto& world : volumePoints(50, 1, 2, 9)) {
    Eigen::Vector3d found;
    ASSERT_TRUE(triangulate(kA, normalized(kA, world), kB, normalized(kB, world), found));
    EXPECT_LT((found - world).norm(), 1e-9);
  }
}

TEST(Triangulation, isAMinimumOfTheReprojectionError) {
  std::mt19937 rng(2);
  for (const auto& world : volumePoints(50, 3, 2, 9)) {
    const Eigen::Vector2d a = normalized(kA, world) + gaussian2(rng, 2e-3);
    const Eigen::Vector2d b = normalized(kB, world) + gaussian2(rng, 2e-3);
    Eigen::Vector3d found;
    ASSERT_TRUE(triangulate(kA, a, kB, b, found));
    const auto cost = [&](const Eigen::Vector3d& p) {
      return (normalized(kA, p) - a).squaredNorm() + (normalized(kB, p) - b).squaredNorm();
    };
    for (int axis = 0; axis < 3; ++axis)
      for (const double step : {-0.01, 0.01})
        EXPECT_LT(cost(found), cost(found + step * Eigen::Vector3d::Unit(axis)));
  }
}

TEST(Triangulation, beginsAtTheMidpointOfTheRays) {
  const Pose T_b_a = kB * kA.inverse();
  std::mt19937 rng(4);
  for (const auto& world : volumePoints(50, 5, 2, 9)) {
    const Eigen::Vector3d truth = kA * world;
    const Eigen::Vector2d a = truth.hnormalized(), b = (T_b_a * truth).hnormalized();
    Eigen::Vector3d found;
    ASSERT_TRUE(rayMidpoint(a, T_b_a, b, found));
    EXPECT_LT((found - truth).norm(), 1e-9);

    // With noise: as far from the one ray as from the other.
    const Eigen::Vector2d noisy = b + gaussian2(rng, 2e-3);
    ASSERT_TRUE(rayMidpoint(a, T_b_a, noisy, found));
    const auto distance = [](const Eigen::Vector3d& p, const Eigen::Vector2d& direction) {
      return p.cross(direction.homogeneous().normalized()).norm();
    };
    EXPECT_NEAR(distance(found, a), distance(T_b_a * found, noisy), 1e-9);
  }
  Eigen::Vector3d untouched = Eigen::Vector3d::Constant(7);
  EXPECT_FALSE(rayMidpoint({0.1, 0.2}, cameraAt({1, 0, 0}, {0, 0, 0}), {0.1, 0.2}, untouched));
  EXPECT_EQ(untouched, Eigen::Vector3d::Constant(7));
}

TEST(Triangulation, refusesParallelRaysAndPointsBehind) {
  Eigen::Vector3d found = Eigen::Vector3d::Constant(7);
  const Pose a, b = cameraAt({1, 0, 0}, {0, 0, 0});
  EXPECT_FALSE(triangulate(a, {0.1, 0.2}, b, {0.1, 0.2}, found)) << "parallel";
  EXPECT_FALSE(triangulate(a, {-0.2, 0}, b, {0.2, 0}, found)) << "they meet behind the cameras";
  EXPECT_FALSE(triangulate(a, {0.1, 0.2}, a, {0.3, 0.2}, found)) << "no baseline";
  EXPECT_EQ(found, Eigen::Vector3d::Constant(7));
}

TEST(Triangulation, parallaxIsTheAngleBetweenTheRays) {
  const Eigen::Vector3d world(0, 0, 5);
  const double angle = 2 * std::atan2(0.5, 5.0);
  EXPECT_NEAR(parallaxCosine(world, {-0.5, 0, 0}, {0.5, 0, 0}), std::cos(angle), 1e-12);
  const Pose a = cameraAt({-0.5, 0, 0}, {0, 0.3, 0}), b = cameraAt({0.5, 0, 0}, {0.2, -0.1, 0});
  EXPECT_NEAR(rayParallaxCosine(a, normalized(a, world), b, normalized(b, world)), std::cos(angle),
              1e-12);
}

}  // namespace
}  // namespace depthscope::slam
