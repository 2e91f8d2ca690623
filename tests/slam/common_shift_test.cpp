#include "slam/common_shift.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/slam/synthetic_scene.hpp"

namespace depthscope::slam {
namespace {

using namespace testing;

constexpr int kRight = 50, kWrong = 450;

/// Feature i of one view against feature i of the other; the first `kRight` are turned and shifted
/// alike, give or take `scatter_px`, the others lie anywhere.
class CommonShiftTest : public ::testing::Test {
 protected:
  void make(float turn, const Eigen::Vector2f& shift, double scatter_px, int right = kRight) {
    std::mt19937 rng(5);
    for (FeatureSet* set : {&first_, &second_}) set->keypoints.clear();
    const Eigen::Vector2f middle(testCamera().cx, testCamera().cy);
    for (int i = 0; i < kRight + kWrong; ++i) {
      Keypoint a = at(randomPixel(rng).cast<float>()), b = at(randomPixel(rng).cast<float>());
      a.angle = static_cast<float>(uniform(rng, -3.1, 3.1));
      b.angle = static_cast<float>(uniform(rng, -3.1, 3.1));
      if (i < right) {
        b = at(Eigen::Rotation2Df(turn) * (Eigen::Vector2f(a.ux, a.uy) - middle) + middle + shift +
               gaussian2(rng, scatter_px).cast<float>());
        b.angle = std::remainder(a.angle + turn + static_cast<float>(gaussian2(rng, 0.1).x()),
                                 2 * std::numbers::pi_v<float>);
      }
      first_.keypoints.push_back(a);
      second_.keypoints.push_back(b);
      matches_.push_back(i);
    }
  }
  static Keypoint at(const Eigen::Vector2f& place) {
    Keypoint k;
    k.ux = place.x();
    k.uy = place.y();
    return k;
  }
  int keptOf(int begin, int end) const {
    return static_cast<int>(std::count_if(matches_.begin() + begin, matches_.begin() + end,
                                          [](int m) { return m >= 0; }));
  }

  FeatureSet first_, second_;
  std::vector<int> matches_;
  CommonShift shift_{testCamera(), kRight + kWrong};
};

TEST_F(CommonShiftTest, FindsATenthOfRightMatchesAmongWrongOnes) {
  make(0.6f, {90, -40}, 30);
  const int kept = shift_.keep(first_, second_, matches_);
  EXPECT_EQ(kept, keptOf(0, kRight + kWrong));
  EXPECT_GT(keptOf(0, kRight), 40);
  EXPECT_LT(keptOf(kRight, kRight + kWrong), 20);
  for (int i = 0; i < kRight + kWrong; ++i) EXPECT_TRUE(matches_[i] == i || matches_[i] == -1);
}

TEST_F(CommonShiftTest, WrongMatchesAloneMakeSmallClusters) {
  make(0, {0, 0}, 0, 0);
  EXPECT_LT(shift_.keep(first_, second_, matches_), 20);
}

TEST_F(CommonShiftTest, NothingComesOfNothing) {
  EXPECT_EQ(shift_.keep(first_, second_, matches_), 0);
}

}  // namespace
}  // namespace depthscope::slam
