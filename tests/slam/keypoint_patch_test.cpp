// What is computed from the patch of one keypoint: its sub-pixel place, direction and descriptor.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "slam/brief_descriptor.hpp"
#include "slam/brief_pattern.hpp"
#include "slam/corner_refinement.hpp"
#include "slam/orientation.hpp"
#include "tests/slam/tissue_picture.hpp"

namespace depthscope::slam {
namespace {

constexpr int kCentre = 40;

/// 81 x 81 pixels of the texture around (x, y), turned by `angle` about the middle.
ImageBuffer patchAt(double x, double y, double angle, double gain = 1) {
  const testing::TissueTexture texture(11);
  const double c = std::cos(angle), s = std::sin(angle);
  return testing::draw(2 * kCentre + 1, 2 * kCentre + 1, [&](double u, double v) {
    const double du = u - kCentre, dv = v - kCentre;
    return gain * texture(x + c * du + s * dv, y - s * du + c * dv);
  });
}

const std::uint8_t* middle(const ImageBuffer& image) {
  return image.row(kCentre) + kCentre;
}

double angleBetween(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * std::numbers::pi));
}

TEST(CornerRefinement, FindsTheMiddleOfASpot) {
  for (const double dx : {-0.4, -0.1, 0.0, 0.3})
    for (const double dy : {-0.3, 0.0, 0.45}) {
      const ImageBuffer spot =
          testing::draw(2 * kCentre + 1, 2 * kCentre + 1, [&](double x, double y) {
            const double r2 = std::pow(x - kCentre - dx, 2) + std::pow(y - kCentre - dy, 2);
            return 160 - 100 * std::exp(-r2 / (2 * 1.5 * 1.5));
          });
      const Eigen::Vector2d offset = refineCorner(middle(spot), spot.stride());
      EXPECT_NEAR(offset.x(), dx, 0.15);
      EXPECT_NEAR(offset.y(), dy, 0.15);
    }
}

TEST(CornerRefinement, StaysWhereThereIsNoMaximum) {
  const ImageBuffer flat =
      testing::draw(2 * kCentre + 1, 2 * kCentre + 1, [](double, double) { return 90; });
  EXPECT_EQ(refineCorner(middle(flat), flat.stride()), Eigen::Vector2d::Zero());
}

TEST(Orientation, PointsToTheBrightSide) {
  for (double angle = -3; angle < 3; angle += 0.37) {
    const ImageBuffer ramp =
        testing::draw(2 * kCentre + 1, 2 * kCentre + 1, [&](double x, double y) {
          return 128 + 2 * (std::cos(angle) * (x - kCentre) + std::sin(angle) * (y - kCentre));
        });
    EXPECT_LT(angleBetween(intensityCentroidAngle(middle(ramp), ramp.stride()), angle), 0.03);
  }
}

TEST(Orientation, TurnsWithThePatch) {
  for (int i = 0; i < 20; ++i) {
    const ImageBuffer upright = patchAt(50 * i, 30 * i, 0), turned = patchAt(50 * i, 30 * i, 0.8);
    const float a = intensityCentroidAngle(middle(upright), upright.stride());
    const float b = intensityCentroidAngle(middle(turned), turned.stride());
    EXPECT_LT(angleBetween(b - a, 0.8), 0.2);
  }
}

TEST(BriefPattern, StaysInThePatchAtEveryAngleAndHasNoEmptyOrRepeatedTest) {
  for (std::size_t i = 0; i < kBriefPattern.size(); ++i) {
    const BriefTest& t = kBriefPattern[i];
    EXPECT_LE(std::hypot(t.x0, t.y0), 14.5);
    EXPECT_LE(std::hypot(t.x1, t.y1), 14.5);
    EXPECT_FALSE(t.x0 == t.x1 && t.y0 == t.y1);
    for (std::size_t j = 0; j < i; ++j) {
      const BriefTest& o = kBriefPattern[j];
      EXPECT_FALSE(t.x0 == o.x0 && t.y0 == o.y0 && t.x1 == o.x1 && t.y1 == o.y1);
      EXPECT_FALSE(t.x0 == o.x1 && t.y0 == o.y1 && t.x1 == o.x0 && t.y1 == o.y0);
    }
  }
}

TEST(BriefDescriptor, OfATurnedAndDimmedPatchIsCloseAndOfAnotherFar) {
  const BriefDescriptor describe;
  double same = 0, other = 0;
  for (int i = 0; i < 50; ++i) {
    const ImageBuffer upright = patchAt(50 * i, 30 * i, 0);
    const double angle = -3 + 0.12 * i;
    const ImageBuffer turned = patchAt(50 * i, 30 * i, angle, 0.7);
    const ImageBuffer another = patchAt(50 * i + 1000, 30 * i, 0);
    const Descriptor d = describe(middle(upright), upright.stride(), 0);
    same +=
        hammingDistance(d, describe(middle(turned), turned.stride(), static_cast<float>(angle)));
    other += hammingDistance(d, describe(middle(another), another.stride(), 0));
  }
  EXPECT_LT(same / 50, 30);
  EXPECT_NEAR(other / 50, 128, 12);
}

TEST(Descriptor, DistanceCountsDifferingBits) {
  Descriptor a, b;
  EXPECT_EQ(hammingDistance(a, b), 0);
  b.bits = {1, 0, std::uint64_t{1} << 63, 0xFF};
  EXPECT_EQ(hammingDistance(a, b), 10);
  for (auto& word : a.bits) word = ~std::uint64_t{0};
  EXPECT_EQ(hammingDistance(a, Descriptor{}), 256);
}

}  // namespace
}  // namespace depthscope::slam
