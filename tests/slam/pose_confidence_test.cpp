#include "slam/pose_confidence.hpp"

#include <gtest/gtest.h>

#include "slam/pose_optimizer.hpp"
#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

/// Covariance of the pose from points within `half_width_px` of the picture's centre.
Matrix6d covarianceFrom(int points, double half_width_px, double noise_px) {
  std::mt19937 rng(6);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < points; ++i) {
    PoseObservation o;
    const Eigen::Vector2d px(uniform(rng, 320 - half_width_px, 320 + half_width_px),
                             uniform(rng, 240 - half_width_px, 240 + half_width_px));
    o.point_world = uniform(rng, 4, 6) * testCamera().normalize(px).homogeneous();
    o.pixel = px + gaussian2(rng, noise_px);
    observations.push_back(o);
  }
  Pose pose;
  const PoseOptimizerResult result = optimizePose(testCamera(), observations, pose);
  EXPECT_TRUE(result.ok);
  return result.covariance * (result.rms_px * result.rms_px / 2);
}

TEST(PictureSigma, IsTheSpreadOfTheErrorsThatPosesHave) {
  // Of many poses from noisy points: how far off they draw a point, against what one foretells.
  constexpr double kNoise_px = 0.8;
  std::mt19937 rng(1);
  double squared = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<PoseObservation> observations;
    for (int i = 0; i < 60; ++i) {
      PoseObservation o;
      const Eigen::Vector2d px = randomPixel(rng);
      o.point_world = uniform(rng, 4, 6) * testCamera().normalize(px).homogeneous();
      o.pixel = px + gaussian2(rng, kNoise_px);
      observations.push_back(o);
    }
    Pose pose;
    ASSERT_TRUE(optimizePose(testCamera(), observations, pose).ok);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        const Eigen::Vector2d px((column + 0.5) * kWidth_px / 3, (row + 0.5) * kHeight_px / 3);
        const Eigen::Vector3d p = 5 * testCamera().normalize(px).homogeneous();
        squared += (testCamera().project(pose * p) - px).squaredNorm() / (9 * kTrials);
      }
  }
  const double foretold = pictureSigma_px(covarianceFrom(60, 320, kNoise_px), 5, testCameraModel());
  EXPECT_GT(std::sqrt(squared), 0.6 * foretold);
  EXPECT_LT(std::sqrt(squared), 1.7 * foretold);
}

TEST(PictureSigma, GrowsWherePointsCrowdAndWhereTheyAreFew) {
  const double all_over = pictureSigma_px(covarianceFrom(200, 240, 0.5), 5, testCameraModel());
  const double few = pictureSigma_px(covarianceFrom(20, 240, 0.5), 5, testCameraModel());
  const double crowded = pictureSigma_px(covarianceFrom(200, 30, 0.5), 5, testCameraModel());
  EXPECT_LT(all_over, 0.5);
  EXPECT_GT(few, 2 * all_over);
  EXPECT_GT(crowded, 2 * all_over);
}

TEST(PoseConfidence, FallsWhereAnOverlayMayLieMoreThanAPixelOff) {
  TrackedFrame frame(400, testCameraModel());
  for (int i = 0; i < 400; ++i) {
    Keypoint k;
    k.x = static_cast<float>(i % 20) * 32 + 16;
    k.y = static_cast<float>(i / 20) * 24 + 12;
    frame.features.keypoints.push_back(k);
    frame.features.descriptors.push_back({});
    frame.points[i].id = i;
  }
  frame.depth = 5;
  frame.covariance = Matrix6d::Identity() * 1e-10;
  EXPECT_FLOAT_EQ(poseConfidence(frame, 400, 90, testCameraModel()), 1);
  frame.covariance.diagonal().head<3>().setConstant(1e-4);  // 0.01 rad: 5 px
  EXPECT_LT(poseConfidence(frame, 400, 90, testCameraModel()), 0.3f);
  EXPECT_GT(poseConfidence(frame, 400, 90, testCameraModel()), 0.05f);
}

}  // namespace
}  // namespace depthscope::slam
