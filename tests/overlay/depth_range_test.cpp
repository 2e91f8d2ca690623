#include "overlay/depth_range.hpp"

#include <gmock/gmock.h>

#include "tests/overlay/overlay_scene.hpp"

namespace depthscope::overlay {
namespace {

std::vector<Eigen::Vector3f> points(float near_depth, float far_depth) {
  return wall(-10, 10, -10, 10, near_depth, far_depth, 30).vertices;
}

TEST(DepthRange, SpansTheBulkOfWhatIsInView) {
  DepthRange range;
  auto p = points(40, 80);
  p.push_back({0, 0, 5});  // one stray point each way
  p.push_back({0, 0, 500});
  p.push_back({1000, 0, 300});  // out of view
  range.update(p, {}, testCamera(), -1);
  ASSERT_TRUE(range.valid());
  EXPECT_NEAR(range.nearDepth(), 41, 1.5);
  EXPECT_NEAR(range.farDepth(), 79, 1.5);
}

TEST(DepthRange, MovesSlowlyAndOnlyWithTime) {
  DepthRange range;
  range.update(points(40, 80), {}, testCamera(), -1);
  const float before = range.nearDepth();
  range.update(points(60, 100), {}, testCamera(), 0);
  EXPECT_EQ(range.nearDepth(), before);
  range.update(points(60, 100), {}, testCamera(), 1.0 / 30);
  EXPECT_GT(range.nearDepth(), before);
  EXPECT_LT(range.nearDepth(), before + 2);
  for (int i = 0; i < 150; ++i) range.update(points(60, 100), {}, testCamera(), 1.0 / 30);
  EXPECT_NEAR(range.nearDepth(), before + 20, 0.5);
}

TEST(DepthRange, KeepsWhatItKnewWhileTheSurfaceIsOutOfView) {
  DepthRange range;
  range.update(points(-80, -40), {}, testCamera(), -1);
  EXPECT_FALSE(range.valid());
  range.update(points(40, 80), {}, testCamera(), -1);
  const float before = range.farDepth();
  range.update(points(-80, -40), {}, testCamera(), -1);
  EXPECT_EQ(range.farDepth(), before);
}

TEST(DepthRange, GivesAFlatWallASpanOfItsOwn) {
  DepthRange range;
  range.update(points(50, 50), {}, testCamera(), -1);
  EXPECT_GT(range.farDepth() - range.nearDepth(), 5);
}

}  // namespace
}  // namespace depthscope::overlay
