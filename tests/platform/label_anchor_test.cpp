#include "platform/label_anchor.hpp"

#include <gtest/gtest.h>

#include "expect_input_error.hpp"
#include "platform/label_board.hpp"
#include "tests/platform/lens_camera.hpp"

namespace depthscope::platform {
namespace {

using ::testing::HasSubstr;

/// Two parallel squares across the view, at depth 5 and 10 of the world.
SurfaceMesh twoPlanes() {
  SurfaceMesh mesh;
  mesh.map_id = 3;
  for (float z : {10.0f, 5.0f}) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (auto [x, y] : {std::pair{-9.f, -9.f}, {9.f, -9.f}, {9.f, 9.f}, {-9.f, 9.f}}) {
      mesh.vertices.emplace_back(x, y, z);
      mesh.normals.emplace_back(0.f, 0.f, -1.f);
      mesh.confidence.push_back(1);
    }
    mesh.triangles.push_back({base, base + 2, base + 1});
    mesh.triangles.push_back({base, base + 3, base + 2});
  }
  return mesh;
}

TEST(LabelAnchor, LiesOnTheNearestSurfaceUnderThePixel) {
  const CameraModel c = lensCamera();
  const Pose T_camera_world = Pose().retract({0.1, -0.2, 0.05}, {0.3, -0.1, 0.5});
  const Eigen::Vector2d pixel(400, 200);
  const auto anchor = anchorOnSurface(twoPlanes(), c, T_camera_world, pixel);
  ASSERT_TRUE(anchor);
  EXPECT_NEAR(anchor->z(), 5, 1e-4);
  EXPECT_LT((c.project(T_camera_world * anchor->cast<double>()) - pixel).norm(), 1e-3);
}

TEST(LabelAnchor, IsNowhereWithoutASurfaceUnderThePixel) {
  Pose behind;
  behind.t.z() = -20;  // the camera has both planes behind it
  EXPECT_FALSE(anchorOnSurface(twoPlanes(), lensCamera(), behind, {320, 240}));
  EXPECT_FALSE(anchorOnSurface(SurfaceMesh(), lensCamera(), Pose(), {320, 240}));
}

TEST(LabelAnchor, ParsesTextAndPlace) {
  const LabelRequest r = parseLabelRequest("me@home, a vessel@12.5,300");
  EXPECT_EQ(r.text, "me@home, a vessel");
  EXPECT_EQ(r.pixel, Eigen::Vector2d(12.5, 300));
  for (const char* bad :
       {"", "text", "@1,2", "text@1", "text@1,", "text@,2", "text@a,b", "text@1,2x", "text@nan,1"})
    EXPECT_INPUT_ERROR(parseLabelRequest(bad), HasSubstr("TEXT@X,Y"));
}

TEST(LabelBoard, AnchorsOnceAndOnlyInTheSurfacesOwnMap) {
  LabelBoard board({{"vessel", {320, 240}}, {"outside", {-1e5, -1e5}}});
  PoseEstimate estimate;
  estimate.state = TrackingState::Tracking;
  estimate.map_id = 2;
  const SurfaceMesh mesh = twoPlanes();
  EXPECT_FALSE(board.anchorWaiting(mesh, lensCamera(), estimate));
  estimate.map_id = 3;
  estimate.state = TrackingState::Lost;
  EXPECT_FALSE(board.anchorWaiting(mesh, lensCamera(), estimate));
  estimate.state = TrackingState::Tracking;
  EXPECT_TRUE(board.anchorWaiting(mesh, lensCamera(), estimate));
  ASSERT_EQ(board.labels().size(), 1u);
  EXPECT_EQ(board.labels()[0].text, "vessel");
  EXPECT_EQ(board.labels()[0].map_id, 3u);
  EXPECT_FALSE(board.anchorWaiting(mesh, lensCamera(), estimate));
}

}  // namespace
}  // namespace depthscope::platform
