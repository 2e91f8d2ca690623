#include "recon/mls_smoothing.hpp"

#include <gmock/gmock.h>

#include "recon/point_filters.hpp"
#include "synthetic_cloud.hpp"

namespace depthscope::recon {
namespace {

constexpr float kSpacing = 0.1f;

TEST(MlsSmooth, TakesNoiseOffAPlane) {
  const auto smooth = mlsSmooth(usablePoints(heightCloud(flat, 30, 0.03f), {}), kSpacing, {});
  ASSERT_GT(smooth->size(), 700u);
  double square = 0;
  for (const auto& p : *smooth) square += p.z * p.z;
  // Uniform noise of +-0.03 has a standard deviation of 0.017.
  EXPECT_LT(std::sqrt(square / static_cast<double>(smooth->size())), 0.008);
}

TEST(MlsSmooth, KeepsTheCurvatureOfASphere) {
  const auto smooth = mlsSmooth(usablePoints(heightCloud(cap, 30, 0), {}), kSpacing, {});
  for (const auto& p : *smooth)
    EXPECT_NEAR((p.getVector3fMap() - Eigen::Vector3f(0, 0, -2)).norm(), 2.f, 2e-3);
}

TEST(MlsSmooth, TurnsNormalsTowardsTheCamerasOnEitherSide) {
  for (float side : {1.f, -1.f}) {
    SparseCloud cloud = heightCloud(flat, 20, 0.01f);
    for (auto& p : cloud.points) p.view_direction.z() *= side;
    const auto smooth = mlsSmooth(usablePoints(cloud, {}), kSpacing, {});
    ASSERT_FALSE(smooth->empty());
    for (const auto& p : *smooth) EXPECT_GT(p.normal_z * side, 0.9f);
  }
}

TEST(MlsSmooth, LeavesOutPointsFarFromTheFit) {
  SparseCloud cloud = heightCloud(flat, 30, 0.005f);
  for (std::size_t i = 13; i < cloud.points.size(); i += 97) cloud.points[i].position.z() = 0.15f;
  const auto smooth = mlsSmooth(usablePoints(cloud, {}), kSpacing, {});
  for (const auto& p : *smooth) EXPECT_LT(std::abs(p.z), 0.03f);
}

TEST(MlsSmooth, LeavesOutWhatWasSeenAtAGrazingAngle) {
  SparseCloud cloud = heightCloud(flat, 20, 0.f);
  for (auto& p : cloud.points) p.view_direction = Eigen::Vector3f(1, 0, 0.05f).normalized();
  EXPECT_TRUE(mlsSmooth(usablePoints(cloud, {}), kSpacing, {})->empty());
}

}  // namespace
}  // namespace depthscope::recon
