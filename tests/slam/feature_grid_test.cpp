#include "slam/feature_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace depthscope::slam {
namespace {

using testing::UnorderedElementsAreArray;

CameraModel wideLens() {
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 400;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.k = {-0.2, 0.03, 0, 0, 0};
  return camera;
}

std::vector<Keypoint> scattered(int count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> x(-300, 1000), y(-300, 800);
  std::vector<Keypoint> keypoints(count);
  for (Keypoint& k : keypoints) {
    k.ux = x(rng);
    k.uy = y(rng);
    k.octave = static_cast<std::uint8_t>(rng() % 8);
  }
  return keypoints;
}

std::vector<std::uint32_t> bruteForce(const std::vector<Keypoint>& keypoints, float ux, float uy,
                                      float radius, int min_octave, int max_octave) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints[i];
    const float dx = k.ux - ux, dy = k.uy - uy;
    if (dx * dx + dy * dy < radius * radius && k.octave >= min_octave && k.octave <= max_octave)
      found.push_back(i);
  }
  return found;
}

TEST(FeatureGrid, FindsWhatBruteForceFindsInsideAndOutsideThePicture) {
  const std::vector<Keypoint> keypoints = scattered(1000, 1);
  FeatureGrid grid(1000, wideLens());
  grid.build(keypoints);
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> x(-400, 1100), y(-400, 900), r(1, 150);
  std::vector<std::uint32_t> out(1000);
  for (int i = 0; i < 500; ++i) {
    const float ux = x(rng), uy = y(rng), radius = r(rng);
    const int low = static_cast<int>(rng() % 4), high = low + static_cast<int>(rng() % 4);
    const int n = grid.query(ux, uy, radius, low, high, out);
    EXPECT_THAT(std::vector(out.begin(), out.begin() + n),
                UnorderedElementsAreArray(bruteForce(keypoints, ux, uy, radius, low, high)));
  }
}

TEST(FeatureGrid, BuildForgetsTheKeypointsBefore) {
  FeatureGrid grid(1000, wideLens());
  grid.build(scattered(1000, 3));
  std::vector<Keypoint> one(1);
  one[0].ux = 100;
  one[0].uy = 50;
  grid.build(one);
  std::vector<std::uint32_t> out(1000);
  EXPECT_EQ(grid.query(320, 240, 2000, 0, 7, out), 1);
  EXPECT_EQ(out[0], 0U);
}

TEST(FeatureGrid, FillsNoMoreThanTheRoomGiven) {
  FeatureGrid grid(1000, wideLens());
  grid.build(scattered(1000, 4));
  std::vector<std::uint32_t> out(10, 4711);
  EXPECT_EQ(grid.query(320, 240, 2000, 0, 7, std::span(out).first(9)), 9);
  EXPECT_EQ(out[9], 4711U);
}

TEST(FeatureGrid, BeforeTheFirstBuildNothingIsFound) {
  FeatureGrid grid(10, wideLens());
  std::vector<std::uint32_t> out(10);
  EXPECT_EQ(grid.query(320, 240, 2000, 0, 7, out), 0);
  EXPECT_EQ(FeatureGrid().query(320, 240, 2000, 0, 7, out), 0);
}

}  // namespace
}  // namespace depthscope::slam
