#include "types/camera_model.hpp"

#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <vector>

namespace depthscope {
namespace {

CameraModel pinhole() {
  CameraModel c;
  c.width = 640;
  c.height = 480;
  c.fx = 520;
  c.fy = 515;
  c.cx = 322;
  c.cy = 236;
  c.k = {-0.32, 0.14, 0.001, -0.0012, -0.03};
  return c;
}

CameraModel fisheye() {
  CameraModel c = pinhole();
  c.kind = CameraModel::Kind::Fisheye;
  c.fx = 280;
  c.fy = 282;
  c.k = {-0.02, 0.01, -0.006, 0.001, 0};
  return c;
}

cv::Matx33d matrix(const CameraModel& c) {
  return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
}

std::vector<cv::Point2d> pixelGrid(const CameraModel& c) {
  std::vector<cv::Point2d> pixels;
  for (int y = 0; y < c.height; y += 24)
    for (int x = 0; x < c.width; x += 24) pixels.emplace_back(x, y);
  return pixels;
}

std::vector<cv::Point3d> points() {
  std::vector<cv::Point3d> p;
  for (double x = -1.2; x <= 1.2; x += 0.3)
    for (double y = -0.9; y <= 0.9; y += 0.3) p.emplace_back(x, y, 2 + 0.3 * x - 0.2 * y);
  return p;
}

TEST(CameraModel, projectsLikeOpenCvsPinhole) {
  const CameraModel c = pinhole();
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points(), cv::Vec3d(), cv::Vec3d(), matrix(c),
                    cv::Vec<double, 5>(c.k[0], c.k[1], c.k[2], c.k[3], c.k[4]), expected);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const cv::Point3d p = points()[i];
    const Eigen::Vector2d px = c.project({p.x, p.y, p.z});
    EXPECT_NEAR(px.x(), expected[i].x, 1e-9);
    EXPECT_NEAR(px.y(), expected[i].y, 1e-9);
  }
}

TEST(CameraModel, projectsLikeOpenCvsFisheye) {
  const CameraModel c = fisheye();
  std::vector<cv::Point2d> expected;
  cv::fisheye::projectPoints(points(), expected, cv::Vec3d(), cv::Vec3d(), matrix(c),
                             cv::Vec4d(c.k[0], c.k[1], c.k[2], c.k[3]));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const cv::Point3d p = points()[i];
    const Eigen::Vector2d px = c.project({p.x, p.y, p.z});
    EXPECT_NEAR(px.x(), expected[i].x, 1e-9);
    EXPECT_NEAR(px.y(), expected[i].y, 1e-9);
  }
}

TEST(CameraModel, undistortsLikeOpenCvsPinhole) {
  const CameraModel c = pinhole();
  std::vector<cv::Point2d> expected;
  cv::undistortPoints(pixelGrid(c), expected, matrix(c),
                      cv::Vec<double, 5>(c.k[0], c.k[1], c.k[2], c.k[3], c.k[4]), cv::noArray(),
                      cv::noArray(), cv::TermCriteria(cv::TermCriteria::COUNT, 200, 0));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Eigen::Vector2d n = c.unproject({pixelGrid(c)[i].x, pixelGrid(c)[i].y});
    EXPECT_NEAR(n.x(), expected[i].x, 1e-8);
    EXPECT_NEAR(n.y(), expected[i].y, 1e-8);
  }
}

TEST(CameraModel, undistortsLikeOpenCvsFisheye) {
  const CameraModel c = fisheye();
  std::vector<cv::Point2d> expected;
  cv::fisheye::undistortPoints(pixelGrid(c), expected, matrix(c),
                               cv::Vec4d(c.k[0], c.k[1], c.k[2], c.k[3]));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Eigen::Vector2d n = c.unproject({pixelGrid(c)[i].x, pixelGrid(c)[i].y});
    EXPECT_NEAR(n.x(), expected[i].x, 1e-6 * (1 + n.norm()));
    EXPECT_NEAR(n.y(), expected[i].y, 1e-6 * (1 + n.norm()));
  }
}

TEST(CameraModel, distortUndoesUndistortAllOverThePicture) {
  for (const CameraModel& c : {pinhole(), fisheye()}) {
    for (const cv::Point2d& p : pixelGrid(c)) {
      const Eigen::Vector2d px(p.x, p.y);
      const Eigen::Vector2d n = c.unproject(px);
      ASSERT_TRUE(n.allFinite());
      EXPECT_LT((c.toPixel(c.distort(n)) - px).norm(), 1e-6);
    }
  }
}

TEST(CameraModel, withoutDistortionIsAPinhole) {
  CameraModel c = pinhole();
  c.k = {};
  EXPECT_FALSE(c.hasDistortion());
  const Eigen::Vector2d px = c.project({0.4, -0.2, 2});
  EXPECT_DOUBLE_EQ(px.x(), 520 * 0.2 + 322);
  EXPECT_DOUBLE_EQ(px.y(), 515 * -0.1 + 236);
  EXPECT_LT((c.unproject(px) - Eigen::Vector2d(0.2, -0.1)).norm(), 1e-15);
}

TEST(CameraModel, undistortStaysFiniteWhereTheLensFoldsOver) {
  CameraModel c = pinhole();
  c.k = {-0.6, 0, 0, 0, 0};  // distorted radius has its maximum at 0.5
  for (double r = 0; r < 5; r += 0.1) EXPECT_TRUE(c.undistort({r, 0.3 * r}).allFinite());
}

TEST(CameraModel, theOpticalAxisGoesThroughThePrincipalPoint) {
  for (const CameraModel& c : {pinhole(), fisheye()}) {
    EXPECT_EQ(c.project({0, 0, 3}), Eigen::Vector2d(c.cx, c.cy));
    EXPECT_LT(c.unproject({c.cx, c.cy}).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace depthscope
