#include "platform/map_scale.hpp"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "expect_input_error.hpp"
#include "tests/platform/lens_camera.hpp"
#include "tests/types/grid_mesh.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

/// A height field z(x, y) over [-side, side]^2 as a mesh, in map units.
template <class Height>
SurfaceMesh heightField(float side, Height&& z) {
  SurfaceMesh mesh = gridMesh(120, [&](float u, float v) {
    const float x = side * (2 * u - 1), y = side * (2 * v - 1);
    return Eigen::Vector3f(x, y, z(x, y));
  });
  mesh.map_id = 4;
  return mesh;
}

SurfaceMesh tiltedPlane() {
  return heightField(2, [](float x, float y) { return 3 + 0.5f * x - 0.2f * y; });
}

Pose someView() {
  return Pose().retract({0.1, -0.15, 0.4}, {0.2, -0.1, 0.3});
}

/// A request for the length between two points of the world.
ScaleRequest between(const Eigen::Vector3d& p, const Eigen::Vector3d& q, double mm) {
  const CameraModel c = lensCamera();
  return {ScaleRequest::Kind::Length, mm, c.project(someView() * p), c.project(someView() * q)};
}

TEST(MapScale, IsTheLengthOverTheDistanceOnATiltedPlane) {
  const Eigen::Vector3d p(-0.4, 0.2, 3 - 0.2 - 0.04), q(0.5, -0.1, 3 + 0.25 + 0.02);
  const MapScale scale =
      measureScale(tiltedPlane(), lensCamera(), someView(), between(p, q, 25.0 * (p - q).norm()));
  EXPECT_NEAR(scale.mm_per_unit, 25, 1e-3);
  EXPECT_EQ(scale.map_id, 4u);
}

TEST(MapScale, IsTheChordBetweenPointsOfASphere) {
  const auto sphere = [](float x, float y) { return 4 - std::sqrt(2 - x * x - y * y); };
  const Eigen::Vector3d p(-0.6, 0.1, sphere(-0.6f, 0.1f)), q(0.3, 0.5, sphere(0.3f, 0.5f));
  const MapScale scale = measureScale(heightField(0.9f, sphere), lensCamera(), someView(),
                                      between(p, q, 12.0 * (p - q).norm()));
  EXPECT_NEAR(scale.mm_per_unit, 12, 12 * 1e-3);
}

TEST(MapScale, TheUncertaintyIsThatOfPickingSeenStraightOn) {
  // At depth 3 and focal length 500, a pixel is 0.006 wide; only errors along the length count.
  CameraModel pinhole = lensCamera();
  pinhole.k = {};
  const SurfaceMesh plane = heightField(2, [](float, float) { return 3.f; });
  const ScaleRequest r{ScaleRequest::Kind::Length, 10, {270, 240}, {370, 240}};
  const MapScale scale = measureScale(plane, pinhole, Pose(), r);
  EXPECT_NEAR(scale.mm_per_unit, 10 / 0.6, 1e-4);
  EXPECT_NEAR(scale.uncertainty_mm / scale.mm_per_unit, 1.5 * std::numbers::sqrt2 / 100, 1e-4);
}

TEST(MapScale, LooksTowardsTheUncertaintyOfDepthOnASteepSurface) {
  CameraModel pinhole = lensCamera();
  pinhole.k = {};
  const ScaleRequest r{ScaleRequest::Kind::Length, 10, {270, 240}, {370, 240}};
  const auto uncertainty = [&](float slope) {
    const MapScale s = measureScale(heightField(2, [&](float x, float) { return 3 + slope * x; }),
                                    pinhole, Pose(), r);
    return s.uncertainty_mm / s.mm_per_unit;
  };
  EXPECT_GT(uncertainty(4), 1.5 * uncertainty(0));
}

TEST(MapScale, TakesAnInstrumentAtTheDepthOfTheTissueUnderIt) {
  CameraModel pinhole = lensCamera();
  pinhole.k = {};
  // Its ends look past the small piece of surface that it touches.
  const SurfaceMesh plane = heightField(0.1f, [](float, float) { return 3.f; });
  const ScaleRequest r{ScaleRequest::Kind::Diameter, 5, {270, 240}, {370, 240}};
  const MapScale scale = measureScale(plane, pinhole, Pose(), r);
  EXPECT_NEAR(scale.mm_per_unit, 5 / 0.6, 1e-4);
  const double radius = 0.3 / 3;  // of depth
  EXPECT_NEAR(scale.uncertainty_mm / scale.mm_per_unit,
              std::hypot(radius, 1.5 * std::numbers::sqrt2 / 100), 1e-3);
}

TEST(MapScale, RefusesWhatCannotBeMeasured) {
  const CameraModel c = lensCamera();
  const Eigen::Vector3d p(-0.4, 0, 2.8), q(0.4, 0, 3.2);
  const auto measure = [&](ScaleRequest r) {
    return measureScale(tiltedPlane(), c, someView(), r);
  };
  ScaleRequest off = between(p, q, 10);
  off.b = {639, 479};
  EXPECT_INPUT_ERROR(measureScale(heightField(0.5f, [](float, float) { return 3.f; }), c, Pose(),
                                  {ScaleRequest::Kind::Length, 10, {320, 240}, {630, 470}}),
                     HasSubstr("no surface at 630,470"));
  EXPECT_INPUT_ERROR(measureScale(SurfaceMesh(), c, Pose(), off), HasSubstr("no surface at"));
  ScaleRequest near = between(p, q, 10);
  near.b = near.a + Eigen::Vector2d(3, 0);
  EXPECT_INPUT_ERROR(measure(near), HasSubstr("farther apart"));
  near.b = near.a;
  EXPECT_INPUT_ERROR(measure(near), HasSubstr("farther apart"));
  EXPECT_INPUT_ERROR(measure(between(p, q, 400)), HasSubstr("mm away, expected 1 to 500 mm"));
  EXPECT_INPUT_ERROR(measure(between(p, q, 0.1)), HasSubstr("mm away"));
}

TEST(MapScale, ParsesLengthsAndDiameters) {
  const ScaleRequest r = parseScaleRequest("10.5 120,200 300.5,210");
  EXPECT_EQ(r.kind, ScaleRequest::Kind::Length);
  EXPECT_EQ(r.mm, 10.5);
  EXPECT_EQ(r.a, Eigen::Vector2d(120, 200));
  EXPECT_EQ(r.b, Eigen::Vector2d(300.5, 210));
  EXPECT_EQ(parseScaleRequest(" diameter 5  1,2 3,4 ").kind, ScaleRequest::Kind::Diameter);
  for (const char* bad : {"", "10", "10 1,2", "10 1,2 3,4 5,6", "width 10 1,2 3,4"})
    EXPECT_INPUT_ERROR(parseScaleRequest(bad), HasSubstr("MM X1,Y1 X2,Y2"));
  for (const char* bad : {"0 1,2 3,4", "-5 1,2 3,4", "1e9 1,2 3,4", "nan 1,2 3,4", "5mm 1,2 3,4"})
    EXPECT_INPUT_ERROR(parseScaleRequest(bad), HasSubstr("0.1 to 500 mm"));
  for (const char* bad : {"5 1 3,4", "5 1,2 3,", "5 1,x 3,4", "5 1,inf 3,4"})
    EXPECT_INPUT_ERROR(parseScaleRequest(bad), HasSubstr("X,Y in pixels"));
}

TEST(MapScale, PointsLieInThePicture) {
  EXPECT_NO_THROW(requireInPicture(parseScaleRequest("5 0,0 639,479"), lensCamera()));
  for (const char* bad : {"5 -1,0 10,10", "5 10,10 640,10", "5 10,10 10,480"})
    EXPECT_INPUT_ERROR(requireInPicture(parseScaleRequest(bad), lensCamera()),
                       HasSubstr("outside the picture of 640x480"));
}

}  // namespace
}  // namespace depthscope::platform
