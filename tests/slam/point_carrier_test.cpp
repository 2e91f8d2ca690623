#include "slam/point_carrier.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/tissue_picture.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr double kDepth = 2;
constexpr double kShift_px = 7.4;

SlamSettings settings(int features) {
  SlamSettings s;
  s.extractor.features = s.extractor.features_at_most = features;
  s.capacity.keyframes = 4;
  s.capacity.map_points = 1000;
  return s;
}

/// A wall of tissue, all of whose features are points of the map, and the camera a step to the
/// side, whose picture has features but knows none of them.
struct Step {
  SlamSettings setting;
  Map map;
  OrbExtractor extractor;
  PointCarrier carrier;
  TrackedFrame last, frame;
  Pose T_truth;

  explicit Step(int features)
      : setting(settings(features)),
        map(setting, testing::smallCamera()),
        extractor(setting.extractor, testing::smallCamera()),
        carrier(testing::smallCamera(), setting, map, extractor),
        last(features, testing::smallCamera()),
        frame(features, testing::smallCamera()) {
    map.start();
    take(0, last);
    const Intrinsics& c = map.intrinsics();
    for (int f = 0; f < last.features.size(); ++f) {
      const Keypoint& k = last.features.keypoints[f];
      const PointId p = map.addPoint(kDepth * c.normalize({k.ux, k.uy}).homogeneous(), 0);
      last.points[f] = map.ref(p);
    }
    take(kShift_px, frame);
    T_truth.t.x() = kShift_px * kDepth / c.fx;
    frame.T_camera_world.t.x() = 0.6 * T_truth.t.x();  // as a motion model may be wrong
  }

  void take(double shift_px, TrackedFrame& into) {
    const ImageBuffer image = testing::draw(kWidth, kHeight, [&](double x, double y) {
      return 70 + 0.3 * testing::TissueTexture(9)(x - shift_px, y);
    });
    extractor.extract(image.view(), into.features);
  }

  int pointsOfFrame() const {
    int n = 0;
    for (int f = 0; f < frame.features.size(); ++f) n += frame.points[f].id != kNone;
    return n;
  }
};

TEST(PointCarrier, PlacesPointsWhereTheyAreAndAddsItsError) {
  Step step(150);
  step.frame.features.keypoints.clear();
  step.frame.features.descriptors.clear();
  const int carried = step.carrier.carry(step.last, step.frame);
  EXPECT_GT(carried, 100);
  ASSERT_EQ(step.frame.features.size(), carried);
  ASSERT_EQ(step.frame.features.descriptors.size(), step.frame.features.keypoints.size());
  int off = 0;
  for (int f = 0; f < carried; ++f) {
    const Keypoint& k = step.frame.features.keypoints[f];
    const PointId p = step.map.resolve(step.frame.points[f]);
    ASSERT_NE(p, kNone);
    const Eigen::Vector2d expected =
        step.map.intrinsics().project(step.T_truth * step.map.point(p).position);
    off += (expected - Eigen::Vector2d(k.ux, k.uy)).norm() > 3 * k.sigma;
    const float scale = step.extractor.scaleFactors()[k.octave];
    EXPECT_NEAR(k.sigma, std::hypot(0.7, 0.3) * scale, 1e-4);
  }
  EXPECT_LE(off, carried / 50);
}

TEST(PointCarrier, InAFullFrameOnlyFeaturesWithoutPointsGiveWay) {
  Step step(150);
  ASSERT_EQ(step.frame.features.size(), 150);
  // Half of the features are recognised already, as points that the last frame did not see.
  std::vector<PointRef> known(150);
  std::vector<Keypoint> before = step.frame.features.keypoints;
  for (int f = 0; f < 75; ++f)
    known[f] = step.frame.points[f] = step.map.ref(step.map.addPoint({0, 0, kDepth}, 0));
  EXPECT_EQ(step.carrier.carry(step.last, step.frame), 75);
  EXPECT_EQ(step.frame.features.size(), 150);
  for (int f = 0; f < 75; ++f) {
    EXPECT_EQ(step.frame.points[f].id, known[f].id);
    EXPECT_EQ(step.frame.features.keypoints[f].x, before[f].x);
    EXPECT_NE(step.frame.points[75 + f].id, kNone);
  }
}

TEST(PointCarrier, LeavesAloneWhatTheFrameHasAlready) {
  Step step(150);
  const int all = step.last.features.size();
  for (int f = 0; f < all; ++f) step.frame.points[f] = step.last.points[f];
  EXPECT_EQ(step.carrier.carry(step.last, step.frame), 0);
  EXPECT_EQ(step.pointsOfFrame(), all);
}

TEST(PointCarrier, AllocatesNothing) {
  Step step(150);
  testing::takeAllocationCount();
  {
    const AllocationScope scope;
    step.carrier.carry(step.last, step.frame);
  }
  EXPECT_EQ(testing::takeAllocationCount(), 0);
}

}  // namespace
}  // namespace depthscope::slam
