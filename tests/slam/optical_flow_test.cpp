#include "slam/optical_flow.hpp"

#include <gtest/gtest.h>

#include "slam/image_pyramid.hpp"
#include "tests/slam/tissue_picture.hpp"

namespace depthscope::slam {
namespace {

constexpr int kWidth = 320, kHeight = 240;

struct Levels {
  std::vector<ImageBuffer> images;
  std::vector<float> scales;

  explicit Levels(const ImageBuffer& picture) {
    ImagePyramid pyramid(kWidth, kHeight, 8, 1.2);
    pyramid.build(picture.view(), bestSimdPath());
    for (int l = 0; l < pyramid.levels(); ++l) {
      images.push_back(pyramid.level(l));
      scales.push_back(static_cast<float>(pyramid.scale(l)));
    }
  }
  SmoothedPyramid view() const { return {images, scales}; }
};

Levels picture(const std::function<double(double, double)>& brightness) {
  return Levels(testing::draw(kWidth, kHeight, brightness));
}

const testing::TissueTexture kTissue(5);

TEST(OpticalFlow, FollowsAPatchToAFractionOfAPixelInOtherLight) {
  const Levels first = picture([](double x, double y) { return 100 + 0.3 * kTissue(x, y); });
  // Shifted by (9.3, -6.6), darker and with less contrast.
  const Levels second =
      picture([](double x, double y) { return 55 + 0.22 * kTissue(x - 9.3, y + 6.6); });
  for (const int octave : {0, 2, 5}) {
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector2d from(80 + 5.3 * i, 90 + 2.2 * i);
      const auto place =
          followPatch(first.view(), second.view(), from, octave, from + Eigen::Vector2d(6, -4));
      ASSERT_TRUE(place) << from.transpose() << " octave " << octave;
      EXPECT_LT((*place - from - Eigen::Vector2d(9.3, -6.6)).norm(), 0.25 * first.scales[octave]);
    }
  }
}

TEST(OpticalFlow, RefusesWhatHasNoTextureInBothDirections) {
  const Levels flat = picture([](double, double) { return 120; });
  EXPECT_FALSE(followPatch(flat.view(), flat.view(), {160, 120}, 0, {160, 120}));
  const Levels edge = picture([](double x, double) { return x < 160 ? 60 : 160; });
  EXPECT_FALSE(followPatch(edge.view(), edge.view(), {160, 120}, 0, {160, 120}));
}

TEST(OpticalFlow, RefusesAPatchThatHasBecomeAnother) {
  const testing::TissueTexture other(6);
  const Levels first = picture(kTissue), second = picture(other);
  int followed = 0;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector2d from(80 + 5.3 * i, 90 + 2.2 * i);
    followed += followPatch(first.view(), second.view(), from, 0, from).has_value();
  }
  EXPECT_LE(followed, 3);
}

TEST(OpticalFlow, RefusesAPatchThatLeavesThePicture) {
  const Levels first = picture(kTissue);
  const Levels second = picture([](double x, double y) { return kTissue(x + 12, y); });
  EXPECT_TRUE(followPatch(first.view(), second.view(), {40, 120}, 0, {30, 120}));
  EXPECT_FALSE(followPatch(first.view(), second.view(), {18, 120}, 0, {8, 120}));
  EXPECT_FALSE(followPatch(first.view(), second.view(), {40, 120}, 0, {-500, 1e6}));
}

}  // namespace
}  // namespace depthscope::slam
