#include "slam/sim3.hpp"

#include <gtest/gtest.h>

#include <random>

#include "slam/sim3_solver.hpp"
#include "tests/slam/jacobian_check.hpp"
#include "tests/slam/synthetic_scene.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

Vector7d randomTangent(std::mt19937& rng, double size) {
  Vector7d x;
  for (int i = 0; i < 7; ++i) x(i) = uniform(rng, -size, size);
  return x;
}

double distance(const Sim3& a, const Sim3& b) {
  return logSim3(a * b.inverse()).norm();
}

/// Two maps of one scene, the old one's world the true one; `wrong` of the matches are nonsense.
struct TwoMaps {
  Sim3 T_old_new = expSim3((Vector7d() << 0.3, -0.2, 0.5, 0.4, -0.1, 0.3, 0.7).finished());
  Pose T_view_old = cameraAt({0.2, 0, 0}, {0, 0.05, 0});
  std::vector<Sim3Match> matches;

  TwoMaps(int n, int wrong, double noise_px) {
    std::mt19937 rng(9);
    const auto points = volumePoints(4 * n, 5, 4, 8);
    const Pose T_view_true = cameraAt({-0.3, 0.1, 0}, {0.02, -0.04, 0.3});
    // The new map's world is the true one scaled and turned: so is its camera's pose.
    const Pose T_view_new = T_old_new.inverse().moved(T_view_true);
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector3d a = T_view_old * p, b = T_view_true * p;
      if (a.z() < 1 || b.z() < 1 || static_cast<int>(matches.size()) == n) continue;
      Sim3Match m;
      m.point_old = p;
      m.point_new = T_old_new.inverse() * p;
      m.T_view_old = T_view_old;
      m.T_view_new = T_view_new;
      m.pixel_old = testCamera().project(a) + gaussian2(rng, noise_px);
      m.pixel_new = testCamera().project(b) + gaussian2(rng, noise_px);
      matches.push_back(m);
    }
    for (int i = 0; i < wrong; ++i) std::swap(matches[i].point_new, matches[i + wrong].point_new);
    for (int i = 0; i < wrong; ++i) std::swap(matches[i].pixel_new, matches[i + wrong].pixel_new);
  }
};

TEST(Sim3, LogIsTheInverseOfExp) {
  std::mt19937 rng(1);
  for (const double size : {1e-9, 1e-3, 0.1, 1.0, 1.7})
    for (int i = 0; i < 20; ++i) {
      const Vector7d x = randomTangent(rng, size);
      EXPECT_LT((logSim3(expSim3(x)) - x).norm(), 1e-9 * (1 + size)) << x.transpose();
    }
}

TEST(Sim3, ExpOfASumAlongOneDirectionIsTheProduct) {
  std::mt19937 rng(2);
  for (int i = 0; i < 20; ++i) {
    const Vector7d x = randomTangent(rng, 0.8);
    EXPECT_LT(distance(expSim3(0.3 * x) * expSim3(0.7 * x), expSim3(x)), 1e-10);
  }
}

TEST(Sim3, AdjointMovesATangentThroughTheGroup) {
  std::mt19937 rng(3);
  for (int i = 0; i < 20; ++i) {
    const Sim3 T = expSim3(randomTangent(rng, 1));
    const Vector7d x = randomTangent(rng, 0.5);
    EXPECT_LT(distance(T * expSim3(x) * T.inverse(), expSim3(adjoint(T) * x)), 1e-9);
  }
}

TEST(Sim3, LeftJacobianInverseIsTheDerivativeOfTheLogarithm) {
  std::mt19937 rng(4);
  for (int i = 0; i < 20; ++i) {
    const Vector7d x = randomTangent(rng, 0.3);
    EXPECT_TRUE((jacobianMatches<7, 7>(leftJacobianInverse(x), [&](const Vector7d& dx) -> Vector7d {
      return logSim3(expSim3(dx) * expSim3(x));
    })));
  }
}

TEST(Sim3, AMovedCameraSeesTheMovedWorldAlike) {
  std::mt19937 rng(5);
  const Sim3 T_new_old = expSim3(randomTangent(rng, 0.8));
  const Pose camera = cameraAt({0.3, 0.2, -0.5}, {0.1, 0.2, 0.3});
  const Pose moved = T_new_old.moved(camera);
  for (const Eigen::Vector3d& p : volumePoints(20, 3, 4, 8))
    EXPECT_LT((moved * (T_new_old * p) - T_new_old.s * (camera * p)).norm(), 1e-12);
}

TEST(Sim3Solver, AlignsPointsExactly) {
  std::mt19937 rng(6);
  for (const int n : {3, 10}) {
    const Sim3 truth = expSim3(randomTangent(rng, 1));
    const auto from = volumePoints(n, 7, 4, 8);
    std::vector<Eigen::Vector3d> to;
    for (const auto& p : from) to.push_back(truth * p);
    Sim3 found;
    ASSERT_TRUE(alignPoints(from, to, found));
    EXPECT_LT(distance(found, truth), 1e-9);
  }
}

TEST(Sim3Solver, RefusesPointsOnALine) {
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 5; ++i) line.push_back({1.0 * i, 2.0 * i, 3.0 * i});
  Sim3 found;
  EXPECT_FALSE(alignPoints(line, line, found));
}

TEST(Sim3Solver, JacobianOfBothViews) {
  const TwoMaps maps(3, 0, 1);
  for (const Sim3Match& m : maps.matches) {
    Eigen::Matrix<double, 4, 1> r;
    Eigen::Matrix<double, 4, 7> J;
    linearizeSim3(testCamera(), m, maps.T_old_new, r, J);
    EXPECT_TRUE((jacobianMatches<4, 7>(J, [&](const Vector7d& x) -> Eigen::Matrix<double, 4, 1> {
      Eigen::Matrix<double, 4, 1> at;
      Eigen::Matrix<double, 4, 7> unused;
      linearizeSim3(testCamera(), m, expSim3(x) * maps.T_old_new, at, unused);
      return at;
    })));
  }
}

TEST(Sim3Solver, FindsTheSimilarityAmongManyWrongMatches) {
  TwoMaps maps(120, 40, 0.7);  // 80 of them are wrong
  Sim3 found;
  const int inliers = solveSim3(testCamera(), maps.matches, {}, found);
  EXPECT_GE(inliers, 38);
  EXPECT_LE(inliers, 42);
  EXPECT_LT(distance(found, maps.T_old_new), 0.02);
  EXPECT_NEAR(found.s, maps.T_old_new.s, 0.01 * maps.T_old_new.s);
}

TEST(Sim3Solver, FindsNothingInNonsense) {
  TwoMaps maps(120, 60, 0.7);
  Sim3 found;
  EXPECT_EQ(solveSim3(testCamera(), maps.matches, {}, found), 0);
}

TEST(Sim3Solver, RefinementPullsAGuessToTheLeastError) {
  TwoMaps maps(100, 0, 0.5);
  const auto cost = [&](const Sim3& T) {
    double sum = 0;
    for (const Sim3Match& m : maps.matches)
      for (const double e : sim3Errors(testCamera(), m, T, T.inverse())) sum += e;
    return sum;
  };
  std::mt19937 rng(10);
  const Sim3 guess = expSim3(randomTangent(rng, 3e-3)) * maps.T_old_new;
  Sim3 refined = guess;
  EXPECT_GT(refineSim3(testCamera(), maps.matches, {}, refined), 95);
  EXPECT_LT(cost(refined), cost(maps.T_old_new));  // which the noise is not quite at
  EXPECT_LT(cost(refined), 0.5 * cost(guess));
  EXPECT_LT(distance(refined, maps.T_old_new), 0.02);
}

}  // namespace
}  // namespace depthscope::slam
