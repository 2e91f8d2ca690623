#include "slam/feature_follower.hpp"

#include <gtest/gtest.h>

#include <random>

#include "slam/spare_features.hpp"
#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/tissue_picture.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

using testing::takeAllocationCount;

constexpr int kWidth = 320, kHeight = 240, kFeatures = 400, kFinest = 3;

ExtractorSettings settings() {
  ExtractorSettings s;
  s.features = kFeatures;
  return s;
}

/// Tissue that moves to the right, under noise that is new in every picture.
class FeatureFollowerTest : public ::testing::Test {
 protected:
  void show(double shift_px, unsigned tissue = 9) {
    std::normal_distribution<double> noise(0, 10);
    const testing::TissueTexture texture(tissue);
    const ImageBuffer image = testing::draw(kWidth, kHeight, [&](double x, double y) {
      return texture(x - shift_px, y) + noise(random_);
    });
    extractor_.extract(image.view(), features_);
  }

  std::mt19937 random_{1};
  OrbExtractor extractor_{settings(), testing::smallCamera()};
  FeatureSet features_{kFeatures, testing::smallCamera()};
  FeatureFollower follower_{extractor_, kFeatures};
};

TEST_F(FeatureFollowerTest, FollowsCoarseFeaturesThroughNoiseWithoutDrift) {
  show(0);
  const FeatureSet first = features_;
  follower_.begin(first, kFinest);
  const auto begun = follower_.followed().size();
  ASSERT_GT(begun, 60u);
  for (int i = 1; i <= 20; ++i) {
    show(1.5 * i);
    follower_.follow();
  }
  const auto followed = follower_.followed();
  EXPECT_GT(followed.size(), begun / 2);
  double squared = 0;
  int last = -1;
  for (const FeatureFollower::Followed& f : followed) {
    EXPECT_GT(f.feature, last);
    last = f.feature;
    const Keypoint& k = first.keypoints[f.feature];
    EXPECT_GE(k.octave, kFinest);
    squared += (f.place - Eigen::Vector2d(k.x + 30, k.y)).squaredNorm();
    EXPECT_LT((f.pixel - f.place).norm(), 1e-3) << "this lens does not distort";
  }
  EXPECT_LT(std::sqrt(squared / static_cast<double>(followed.size())), 1);
}

TEST_F(FeatureFollowerTest, GivesUpWhatBecameAnother) {
  show(0);
  follower_.begin(features_, kFinest);
  const auto begun = follower_.followed().size();
  show(0, 10);
  EXPECT_LT(follower_.follow(), static_cast<int>(begun / 10));
  show(0);
  EXPECT_LT(follower_.follow(), static_cast<int>(begun / 10)) << "it is not taken up again";
}

TEST_F(FeatureFollowerTest, AllocatesNothingOnceItIsBuilt) {
  show(0);
  const FeatureSet first = features_;
  show(2);
  takeAllocationCount();
  {
    const AllocationScope scope;
    follower_.begin(first, kFinest);
    follower_.follow();
  }
  EXPECT_EQ(takeAllocationCount(), 0);
}

TEST(SpareFeatures, GoBehindTheOthersThenInPlaceOfTheWeakestThatMay) {
  FeatureSet features(4, testing::smallCamera());
  const auto add = [&](float response) {
    features.keypoints.emplace_back().response = response;
    features.descriptors.emplace_back();
  };
  add(30);
  add(10);
  add(20);
  SpareFeatures spare(4);
  spare.collect(features, [](int f) { return f != 0; });
  ASSERT_EQ(spare.slot(features), 3);
  add(5);
  spare.take(3);
  ASSERT_EQ(spare.slot(features), 1) << "the weakest of those that may go, not the new one";
  spare.take(1);
  ASSERT_EQ(spare.slot(features), 2);
  EXPECT_EQ(spare.slot(features), 2) << "until it is taken";
  spare.take(2);
  EXPECT_FALSE(spare.slot(features)) << "the strong one stays";
}

}  // namespace
}  // namespace depthscope::slam
