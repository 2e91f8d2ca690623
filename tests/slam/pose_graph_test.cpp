#include "slam/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_scene.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// Cameras on a circle that look outwards, each with a scale of its own; what they measure of each
/// other is exact, where they think they are is not.
struct Ring {
  std::vector<Sim3> truth;
  PoseGraph graph{64, 256};

  explicit Ring(int cameras) {
    std::mt19937 rng(3);
    for (int i = 0; i < cameras; ++i) {
      const double angle = 2 * std::numbers::pi * i / cameras;
      const Pose T = cameraAt({std::sin(angle), 0, std::cos(angle)}, {0, angle, 0});
      truth.push_back(Sim3(std::exp(uniform(rng, -0.2, 0.2)), Eigen::Matrix3d::Identity(),
                           Eigen::Vector3d::Zero()) *
                      Sim3(T));
    }
    Sim3 drift;
    for (int i = 0; i < cameras; ++i) {
      graph.addNode(drift * truth[i], i == 0);
      drift =
          expSim3((Vector7d() << 0.004, 0.01, -0.006, 0.02, 0.01, 0.01, 0.012).finished()) * drift;
    }
  }
  void tie(int a, int b) { graph.addEdge({a, b, truth[b] * truth[a].inverse(), 1}); }
  double largestError() const {
    double worst = 0;
    for (std::size_t i = 0; i < truth.size(); ++i)
      worst = std::max(worst, logSim3(graph.node(static_cast<int>(i)) * truth[i].inverse()).norm());
    return worst;
  }
};

TEST(PoseGraph, ClosesADriftedRing) {
  Ring ring(40);
  for (int i = 0; i < 40; ++i) ring.tie(i, (i + 1) % 40);
  ASSERT_GT(ring.largestError(), 0.4);
  const PoseGraphSummary summary = ring.graph.solve(30);
  EXPECT_LT(summary.final_cost, 1e-9 * summary.initial_cost);
  EXPECT_LT(ring.largestError(), 1e-4);
}

TEST(PoseGraph, SpreadsAContradictionEvenly) {
  // The loop says that the last camera lies 5 % of the circle off: every edge yields a little.
  Ring ring(40);
  for (int i = 0; i + 1 < 40; ++i) ring.tie(i, i + 1);
  Sim3 wrong;
  wrong.t.x() = 0.3;
  ring.graph.addEdge({39, 0, wrong * ring.truth[0] * ring.truth[39].inverse(), 1});
  ring.graph.solve(30);
  double least = 1, most = 0;
  for (int e = 0; e < ring.graph.edges(); ++e) {
    const double error = ring.graph.error(ring.graph.edge(e)).norm();
    least = std::min(least, error);
    most = std::max(most, error);
  }
  EXPECT_GT(least, 0.0005);
  EXPECT_LT(most, 0.05);
}

TEST(PoseGraph, AHeavierEdgeYieldsLess) {
  PoseGraph graph(3, 4);
  for (int i = 0; i < 3; ++i) graph.addNode(Sim3(), i != 1);
  Sim3 right, left;
  right.t.x() = 0.1;
  left.t.x() = -0.1;
  graph.addEdge({0, 1, right, 3});
  graph.addEdge({2, 1, left, 1});
  graph.solve(20);
  EXPECT_NEAR(graph.node(1).t.x(), 0.05, 1e-3);
}

TEST(PoseGraph, TakesNoMoreThanItHasRoomFor) {
  PoseGraph graph(2, 1);
  EXPECT_EQ(graph.addNode(Sim3(), true), 0);
  EXPECT_EQ(graph.addNode(Sim3(), false), 1);
  EXPECT_EQ(graph.addNode(Sim3(), false), -1);
  EXPECT_TRUE(graph.addEdge({0, 1, Sim3(), 1}));
  EXPECT_FALSE(graph.addEdge({0, 1, Sim3(), 1}));
}

TEST(PoseGraph, GivesTheSameBitsTwiceAndAllocatesNothing) {
  Ring a(40), b(40);
  for (Ring* ring : {&a, &b})
    for (int i = 0; i < 40; ++i) ring->tie(i, (i + 1) % 40);
  takeAllocationCount();
  {
    const AllocationScope counted;
    a.graph.solve(10);
  }
  EXPECT_EQ(takeAllocationCount(), 0);
  b.graph.solve(10);
  for (int i = 0; i < 40; ++i)
    EXPECT_EQ(std::memcmp(&a.graph.node(i), &b.graph.node(i), sizeof(Sim3)), 0);
}

}  // namespace
}  // namespace depthscope::slam
