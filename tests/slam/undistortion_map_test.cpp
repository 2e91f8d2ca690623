#include "slam/undistortion_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace depthscope::slam {
namespace {

CameraModel lens(CameraModel::Kind kind, std::array<double, 5> k) {
  CameraModel camera;
  camera.kind = kind;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 420;
  camera.fy = 415;
  camera.cx = 323.8;
  camera.cy = 236.7;
  camera.k = k;
  return camera;
}

void expectUndoes(const CameraModel& camera) {
  const UndistortionMap map(camera);
  const auto exact = [&](double x, double y) { return camera.toPixel(camera.unproject({x, y})); };
  for (double y = 0.3; y < 479; y += 17.7)
    for (double x = 0.3; x < 639; x += 17.7) {
      const auto point = map({x, y});
      ASSERT_TRUE(point);
      EXPECT_LT((point->pixel - exact(x, y)).norm(), 0.02) << x << ' ' << y;
      const Eigen::Vector2d dx = (exact(x + 0.5, y) - exact(x - 0.5, y));
      const Eigen::Vector2d dy = (exact(x, y + 0.5) - exact(x, y - 0.5));
      const double magnification = std::sqrt(dx.x() * dy.y() - dx.y() * dy.x());
      EXPECT_NEAR(point->magnification, magnification, 0.02 * magnification);
    }
}

TEST(UndistortionMap, UndoesBrownConrady) {
  expectUndoes(lens(CameraModel::Kind::Pinhole, {-0.28, 0.07, 6e-4, -4e-4, 0}));
}

TEST(UndistortionMap, UndoesKannalaBrandt) {
  expectUndoes(lens(CameraModel::Kind::Fisheye, {0.05, -0.01, 0.002, 0, 0}));
}

TEST(UndistortionMap, LeavesPixelsOfAPinholeCameraAlone) {
  const auto point = UndistortionMap(lens(CameraModel::Kind::Pinhole, {}))({12.25, 470.5});
  ASSERT_TRUE(point);
  EXPECT_EQ(point->pixel, Eigen::Vector2d(12.25, 470.5));
  EXPECT_EQ(point->magnification, 1);
}

TEST(UndistortionMap, HasNothingToSayWhereTheLensModelFoldsOver) {
  // r (1 - 0.8 r^2) has its maximum, 0.43, at r = 0.65: the corners at r = 0.95 have no inverse.
  const UndistortionMap map(lens(CameraModel::Kind::Pinhole, {-0.8, 0, 0, 0, 0}));
  EXPECT_FALSE(map({2, 2}));
  EXPECT_TRUE(map({320, 240}));
}

}  // namespace
}  // namespace depthscope::slam
