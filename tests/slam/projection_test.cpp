#include "slam/projection.hpp"

#include <gtest/gtest.h>

#include "tests/slam/jacobian_check.hpp"
#include "tests/slam/synthetic_scene.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

const Pose kPose = cameraAt({0.3, -0.2, 0.1}, {0.2, -0.3, 0.4});
const Eigen::Vector3d kPoints[] = {{0.5, 0.4, 3}, {-1, 0.7, 2}, {0.1, -0.9, 8}};

TEST(Projection, normalizeUndoesProject) {
  const Intrinsics camera = testCamera();
  for (const auto& p : kPoints)
    EXPECT_LT((camera.normalize(camera.project(p)) - p.head<2>() / p.z()).norm(), 1e-14);
}

TEST(Projection, jacobianByPointInCameraFrame) {
  for (const auto& p : kPoints)
    EXPECT_TRUE(
        (jacobianMatches<2, 3>(projectionJacobian(testCamera(), p), [&](const Eigen::Vector3d& d) {
          return testCamera().project(p + d);
        })));
}

TEST(Projection, jacobianByPose) {
  for (const auto& p : kPoints)
    EXPECT_TRUE(
        (jacobianMatches<2, 6>(poseJacobian(testCamera(), kPose * p), [&](const Vector6d& d) {
          return testCamera().project(kPose.retract(d.head<3>(), d.tail<3>()) * p);
        })));
}

TEST(Projection, jacobianByPointInWorldFrame) {
  for (const auto& p : kPoints)
    EXPECT_TRUE((jacobianMatches<2, 3>(
        pointJacobian(projectionJacobian(testCamera(), kPose * p), kPose.R),
        [&](const Eigen::Vector3d& d) { return testCamera().project(kPose * (p + d)); })));
}

TEST(Projection, huberWeightIsTheDerivativeOfHuberCost) {
  for (const double chi2 : {0.5, 3.0, 9.0, 400.0}) {
    const double numeric = (huberCost(chi2 + 1e-6, 2.4) - huberCost(chi2 - 1e-6, 2.4)) / 2e-6;
    EXPECT_NEAR(huberWeight(chi2, 2.4), numeric, 1e-7);
  }
  EXPECT_NEAR(huberCost(2.4 * 2.4, 2.4), huberCost(2.4 * 2.4 + 1e-12, 2.4), 1e-9);
}

}  // namespace
}  // namespace depthscope::slam
