#include "slam/two_view.hpp"

#include <gtest/gtest.h>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/synthetic_scene.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;
using Refusal = TwoViewResult::Refusal;

constexpr int kMatches = 400;

TwoViewInitializer initializer(const TwoViewSettings& settings = {}) {
  return {settings, testCamera(), 1000};
}

/// Direction of the translation and rotation, in degrees off the truth.
void expectMotion(const TwoViewResult& r, const Pose& truth, double rotation_deg,
                  double direction_deg) {
  EXPECT_LT(rotationError(r.T_second_first, truth) / kRadians, rotation_deg);
  const double cosine = r.T_second_first.t.dot(truth.t.normalized());
  EXPECT_LT(std::acos(std::min(1.0, cosine)) / kRadians, direction_deg);
  EXPECT_NEAR(r.T_second_first.t.norm(), 1, 1e-12);
}

/// Median over the points of the error in depth, as a share, after the one scale that is free.
double medianDepthError(const TwoViewResult& r, const std::vector<Eigen::Vector3d>& truth,
                        const Pose& T_second_first) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (r.triangulated[i])
      errors.push_back(std::abs(r.points[i].z() * T_second_first.t.norm() / truth[i].z() - 1));
  std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
  return errors[errors.size() / 2];
}

TEST(TwoView, reconstructsAGeneralScene) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.4, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r)) << static_cast<int>(r.refusal);
  EXPECT_EQ(r.model, TwoViewResult::Model::Essential);
  expectMotion(r, truth, 0.2, 2);
  EXPECT_LT(medianDepthError(r, points, truth), 0.02);
  EXPECT_GT(r.inliers, 220);
  EXPECT_GT(r.median_parallax_deg, 3);
}

/// As from coarse levels of the pyramid.
TEST(TwoView, takesPlacesForAsUncertainAsItIsTold) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.9, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 2, 0, 2);
  TwoViewResult fine, coarse;
  initializer().reconstruct(m.first, m.second, fine);
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, coarse, 2))
      << static_cast<int>(coarse.refusal);
  EXPECT_GT(coarse.inliers, std::max(fine.inliers, kMatches * 3 / 4));
  expectMotion(coarse, truth, 1, 5);
}

TEST(TwoView, reconstructsAPlanarScene) {
  const auto points = planePoints(kMatches, 1, kTilted, 5);
  const Pose truth = cameraAt({0.5, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r)) << static_cast<int>(r.refusal);
  EXPECT_EQ(r.model, TwoViewResult::Model::Homography);
  expectMotion(r, truth, 0.5, 4);
  EXPECT_LT(medianDepthError(r, points, truth), 0.04);
}

TEST(TwoView, refusesAPlaneSeenInMotionAlongTheAxisAsAmbiguous) {
  // Two motions and two planes give the same picture, and both are in front of both cameras.
  const auto points = planePoints(kMatches, 1, kTilted, 5);
  const Pose truth = cameraAt({0.1, 0.05, 0.7}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  EXPECT_FALSE(initializer().reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::Ambiguous);
}

TEST(TwoView, reconstructsFromMotionAlongTheOpticalAxis) {
  const auto points = volumePoints(kMatches, 3, 2, 5);
  const Pose truth = cameraAt({0.02, 0.05, 0.5}, {0.01, 0.02, 0.05});
  const Matches m = project(points, truth, 0.5, 0.2, 4);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r)) << static_cast<int>(r.refusal);
  expectMotion(r, truth, 0.3, 3);
}

TEST(TwoView, reconstructsFromLittleParallaxWhenAllowedTo) {
  // A scope near tissue after a few frames: 3 % of the depth, on a scene with some relief.
  const auto points = volumePoints(kMatches, 5, 4, 6);
  const Pose truth = cameraAt({0.14, 0.05, 0.02}, {0.01, -0.01, 0.02});
  const Matches m = project(points, truth, 0.3, 0.3, 6);
  TwoViewSettings settings;
  settings.max_depth_sigma = 0.3;
  TwoViewResult r;
  ASSERT_TRUE(initializer(settings).reconstruct(m.first, m.second, r))
      << static_cast<int>(r.refusal);
  expectMotion(r, truth, 0.3, 10);
  EXPECT_LT(medianDepthError(r, points, truth), 0.1);
}

/// Near tissue before a far background whose parallax drowns in the noise: every other far point
/// seems to lie behind the cameras.
Matches nearBeforeFar(int near, const Pose& T_second_first, unsigned seed) {
  auto points = volumePoints(near, seed, 3, 6);
  const auto far = volumePoints(kMatches - near, seed + 1, 2000, 4000);
  points.insert(points.end(), far.begin(), far.end());
  return project(points, T_second_first, 0.6, 0, seed + 2);
}

TEST(TwoView, takesFarPointsForFarAndNotForMisfits) {
  const Pose truth = cameraAt({0.2, 0.05, 0.05}, {0.01, -0.01, 0.02});
  TwoViewSettings settings;
  settings.sigma_px = 0.6;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Matches m = nearBeforeFar(kMatches / 2, truth, 3 * seed);
    TwoViewResult r;
    ASSERT_TRUE(initializer(settings).reconstruct(m.first, m.second, r))
        << seed << ": " << static_cast<int>(r.refusal);
    expectMotion(r, truth, 0.2, 10);
  }
}

TEST(TwoView, refusesAStartOfWhichButAFewPointsHaveADepth) {
  const Pose truth = cameraAt({0.2, 0.05, 0.05}, {0.01, -0.01, 0.02});
  TwoViewSettings settings;
  settings.sigma_px = 0.6;
  settings.max_rotation_share = 1;
  settings.min_inliers = 20;
  const Matches m = nearBeforeFar(kMatches / 10, truth, 1);
  TwoViewResult r;
  EXPECT_FALSE(initializer(settings).reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::LowParallax);
  settings.min_reliable_share = 0;
  EXPECT_TRUE(initializer(settings).reconstruct(m.first, m.second, r))
      << static_cast<int>(r.refusal);
}

TEST(TwoView, refusesPureRotation) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto points = volumePoints(kMatches, seed, 3, 7);
    const Pose truth = cameraAt({0, 0, 0}, {0.05 * std::cos(seed), 0.05 * std::sin(seed), 0.02});
    const Matches m = project(points, truth, 1, 0.3, 20 + seed);
    TwoViewResult r;
    EXPECT_FALSE(initializer().reconstruct(m.first, m.second, r));
    EXPECT_EQ(r.refusal, Refusal::RotationOnly);
  }
}

TEST(TwoView, refusesACameraThatStandsStill) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const auto points =
        seed % 2 ? volumePoints(kMatches, seed, 3, 7) : planePoints(kMatches, seed, kTilted, 5);
    const double outliers = seed % 3 ? 0.3 : 0;
    const Matches m = project(points, Pose{}, 1, outliers, 40 + seed);
    TwoViewResult r;
    EXPECT_FALSE(initializer().reconstruct(m.first, m.second, r));
    EXPECT_EQ(r.refusal, Refusal::RotationOnly);
  }
}

TEST(TwoView, refusesTooLittleParallax) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.2, 0, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.3, 0.1, 2);
  TwoViewSettings settings;
  settings.max_depth_sigma = 0.02;
  TwoViewResult r;
  EXPECT_FALSE(initializer(settings).reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::LowParallax);
}

TEST(TwoView, refusesAMotionWhoseDirectionIsHardlyDetermined) {
  const auto points = planePoints(60, 1, kTilted, 5);
  const Pose truth = cameraAt({0.2, 0.05, 0}, {0.01, -0.01, 0.02});
  const Matches m = project(points, truth, 1, 0, 2);
  TwoViewSettings settings;
  settings.min_inliers = 30;
  settings.max_rotation_share = 1;
  TwoViewResult r;
  EXPECT_FALSE(initializer(settings).reconstruct(m.first, m.second, r));
  EXPECT_EQ(r.refusal, Refusal::Uncertain);
}

TEST(TwoView, refusesNonsenseAndTooFewMatches) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  TwoViewResult r;
  const Matches nonsense = project(points, Pose{}, 1, 1, 3);
  EXPECT_FALSE(initializer().reconstruct(nonsense.first, nonsense.second, r));
  const Matches few = project(volumePoints(30, 1, 3, 7), cameraAt({1, 0, 0}, {0, 0, 0}), 0, 0, 3);
  EXPECT_FALSE(initializer().reconstruct(few.first, few.second, r));
  EXPECT_EQ(r.refusal, Refusal::TooFewMatches);
  EXPECT_FALSE(initializer().reconstruct({}, {}, r));
  EXPECT_EQ(r.points.size(), 0u);
}

TEST(TwoView, refusesMatchesThatAreAllTheSame) {
  const std::vector<Eigen::Vector2f> first(200, {100, 100}), second(200, {160, 120});
  TwoViewResult r;
  EXPECT_FALSE(initializer().reconstruct(first, second, r));
}

TEST(TwoView, marksWrongMatches) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Pose truth = cameraAt({0.5, 0.1, 0.05}, {0.02, -0.05, 0.03});
  const Matches m = project(points, truth, 0.5, 0.3, 2);
  TwoViewResult r;
  ASSERT_TRUE(initializer().reconstruct(m.first, m.second, r));
  int wrong = 0;
  for (int i = 0; i < kMatches; ++i) wrong += !m.correct[i] && r.triangulated[i];
  EXPECT_LE(wrong, r.inliers / 30) << "a wrong match may lie on its epipolar line by chance";
}

TEST(TwoView, givesTheSameBitsTwiceAndAllocatesNothing) {
  const auto points = volumePoints(kMatches, 1, 3, 7);
  const Matches m = project(points, cameraAt({0.5, 0.1, 0.05}, {0.02, -0.05, 0.03}), 0.5, 0.3, 2);
  auto two_view = initializer();
  TwoViewResult a, b;
  ASSERT_TRUE(two_view.reconstruct(m.first, m.second, a));
  b = a;
  takeAllocationCount();
  {
    const AllocationScope scope;
    ASSERT_TRUE(two_view.reconstruct(m.first, m.second, b));
  }
  EXPECT_EQ(takeAllocationCount(), 0);
  EXPECT_EQ(a.T_second_first.R, b.T_second_first.R);
  EXPECT_EQ(a.T_second_first.t, b.T_second_first.t);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.triangulated, b.triangulated);
}

}  // namespace
}  // namespace depthscope::slam
