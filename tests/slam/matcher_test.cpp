#include "slam/matcher.hpp"

#include <gtest/gtest.h>

#include "tests/slam/synthetic_map.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

ProjectedPoint lookFor(const FeatureSet& features, int feature, float dx = 0, float radius = 10) {
  const Keypoint& k = features.keypoints[feature];
  return {features.descriptors[feature], k.ux + dx, k.uy, radius, 0, 0, feature};
}

class MatcherTest : public ::testing::Test {
 protected:
  World world_{300};
  std::vector<int> ids_;
  FeatureSet features_ = world_.view(Pose{}, ids_);
  MatchingSettings settings_;
  std::vector<int> matches_ = std::vector<int>(400, kNone);
};

TEST_F(MatcherTest, FindsAProjectedPointWithinItsWindowOnly) {
  Matcher matcher(settings_, 400);
  const std::vector<ProjectedPoint> near{lookFor(features_, 7, 8)}, far{lookFor(features_, 9, 30)};
  EXPECT_EQ(matcher.matchProjected(features_, near, 50, 1, matches_), 1);
  EXPECT_EQ(matches_[7], 0);
  EXPECT_EQ(matcher.matchProjected(features_, far, 50, 1, matches_), 0);
}

TEST_F(MatcherTest, TheSearchRegionWidensEveryWindow) {
  settings_.search_region = 4;
  Matcher matcher(settings_, 400);
  const std::vector<ProjectedPoint> far{lookFor(features_, 9, 30)};
  EXPECT_EQ(matcher.matchProjected(features_, far, 50, 1, matches_), 1);
}

TEST_F(MatcherTest, AFeatureGoesToTheNearerDescriptor) {
  Matcher matcher(settings_, 400);
  std::vector<ProjectedPoint> points{lookFor(features_, 7), lookFor(features_, 7)};
  points[0].descriptor.bits[0] ^= 0xff;  // eight bits off
  EXPECT_EQ(matcher.matchProjected(features_, points, 50, 1, matches_), 1);
  EXPECT_EQ(matches_[7], 1);
}

TEST_F(MatcherTest, LeavesTakenFeaturesAlone) {
  Matcher matcher(settings_, 400);
  matches_[7] = kTaken;
  const std::vector<ProjectedPoint> points{lookFor(features_, 7)};
  EXPECT_EQ(matcher.matchProjected(features_, points, 50, 1, matches_), 0);
  EXPECT_EQ(matches_[7], kTaken);
}

TEST_F(MatcherTest, RejectsAnAmbiguousDescriptor) {
  features_.keypoints[8] = features_.keypoints[7];
  features_.keypoints[8].ux += 2;
  features_.descriptors[8] = features_.descriptors[7];
  features_.descriptors[7].bits[0] ^= 0x0f;
  features_.descriptors[8].bits[1] ^= 0x0f;
  features_.grid.build(features_.keypoints);
  const std::vector<ProjectedPoint> points{{world_.descriptors[ids_[7]], features_.keypoints[7].ux,
                                            features_.keypoints[7].uy, 10, 0, 0, 0}};
  Matcher matcher(settings_, 400);
  EXPECT_EQ(matcher.matchProjected(features_, points, 50, 0.8, matches_), 0);
  EXPECT_EQ(matcher.matchProjected(features_, points, 50, 1.0, matches_), 1);
}

TEST_F(MatcherTest, MatchesTwoViewsForInitialization) {
  std::vector<int> other_ids;
  const FeatureSet other = world_.view(cameraAt({0.2, 0, 0}, {0, 0, 0}), other_ids);
  Matcher matcher(settings_, 400);
  const int n = matcher.matchForInitialization(features_, other, 100, matches_);
  EXPECT_GT(n, 200);
  for (int i = 0; i < features_.size(); ++i) {
    if (matches_[i] < 0) continue;
    EXPECT_EQ(ids_[i], other_ids[matches_[i]]);
  }
}

TEST_F(MatcherTest, StartsFromTheLevelsItIsTold) {
  for (int i = 0; i < features_.size(); ++i) features_.keypoints[i].octave = i % 8;
  features_.grid.build(features_.keypoints);
  Matcher matcher(settings_, 400);
  for (const int finest : {0, Matcher::kInitialLevels}) {
    EXPECT_GT(matcher.matchForInitialization(features_, features_, 100, matches_, finest), 100);
    for (int i = 0; i < features_.size(); ++i)
      if (matches_[i] != kNone) {
        EXPECT_GE(i % 8, finest);
        EXPECT_LT(i % 8, finest + Matcher::kInitialLevels);
      }
  }
}

TEST_F(MatcherTest, DropsMatchesThatTurnAgainstTheRest) {
  FeatureSet other = features_;
  for (int i = 0; i < 20; ++i) other.keypoints[i].angle = 2.f;
  Matcher matcher(settings_, 400);
  EXPECT_EQ(matcher.matchForInitialization(features_, other, 100, matches_), features_.size() - 20);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(matches_[i], kNone);
}

TEST_F(MatcherTest, MatchesByDescriptorWhereverTheFeatureIs) {
  FeatureSet turned = features_;
  for (Keypoint& k : turned.keypoints) std::swap(k.ux, k.uy);
  const std::vector<std::uint8_t> wanted(400, 1);
  Matcher matcher(settings_, 400);
  EXPECT_EQ(matcher.matchByDescriptor(features_, wanted, turned, 50, 0.8, matches_),
            features_.size());
  for (int i = 0; i < features_.size(); ++i) EXPECT_EQ(matches_[i], i);
}

}  // namespace
}  // namespace depthscope::slam
