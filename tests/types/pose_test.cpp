#include "types/pose.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace depthscope {
namespace {

const Pose kA{expSO3({0.3, -0.2, 0.5}), {1, 2, 3}};
const Pose kB{expSO3({-0.1, 0.9, 0.2}), {-2, 0.5, 1}};
const Eigen::Vector3d kPoint(0.7, -1.1, 2.3);

bool near(const Pose& a, const Pose& b, double tolerance) {
  return (a.R - b.R).norm() < tolerance && (a.t - b.t).norm() < tolerance;
}

TEST(Pose, chainsReadOff) {
  EXPECT_LT(((kA * kB) * kPoint - kA * (kB * kPoint)).norm(), 1e-14);
}

TEST(Pose, inverseUndoes) {
  EXPECT_TRUE(near(kA * kA.inverse(), Pose{}, 1e-14));
  EXPECT_TRUE(near(kA.inverse() * kA, Pose{}, 1e-14));
}

TEST(Pose, skewIsTheCrossProduct) {
  const Eigen::Vector3d v(1, -2, 0.5);
  EXPECT_LT((skew(v) * kPoint - v.cross(kPoint)).norm(), 1e-15);
}

TEST(Pose, logUndoesExpUpToHalfATurn) {
  for (const double angle : {0.0, 1e-13, 1e-8, 1e-3, 1.0, 3.0, std::numbers::pi - 1e-6}) {
    const Eigen::Vector3d w = angle * Eigen::Vector3d(0.6, -0.48, 0.64);
    EXPECT_LT((logSO3(expSO3(w)) - w).norm(), 1e-9) << angle;
  }
}

TEST(Pose, expIsARotationOfTheRightAngle) {
  const Eigen::Matrix3d R = expSO3({0, 0, std::numbers::pi / 2});
  EXPECT_LT((R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_NEAR(expSO3({0.4, 2, -1}).determinant(), 1, 1e-14);
}

TEST(Pose, retractIsAMotionFromTheLeft) {
  const Eigen::Vector3d w(0.02, -0.1, 0.3), v(0.5, -0.2, 0.1);
  EXPECT_TRUE(near(kA.retract(w, v), Pose{expSO3(w), v} * kA, 1e-14));
  EXPECT_TRUE(near(kA.retract(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()), kA, 1e-14));
}

TEST(Pose, retractKeepsTheRotationOrthonormal) {
  Pose pose;
  for (int i = 0; i < 10000; ++i) pose = pose.retract({0.1, -0.07, 0.03}, {0, 0, 0});
  EXPECT_TRUE((pose.R * pose.R.transpose()).isIdentity(1e-12));
}

TEST(Pose, quaternionIsTheSameRotation) {
  EXPECT_LT((kA.quaternion().toRotationMatrix() - kA.R).norm(), 1e-14);
}

TEST(Pose, saysWhenItIsNotANumber) {
  Pose pose = kA;
  EXPECT_TRUE(pose.allFinite());
  pose.t.y() = std::nan("");
  EXPECT_FALSE(pose.allFinite());
}

}  // namespace
}  // namespace depthscope
