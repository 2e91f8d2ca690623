#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "slam/cell_distance.hpp"
#include "slam/field_of_view.hpp"
#include "slam/highlight_mask.hpp"
#include "tests/slam/tissue_picture.hpp"

namespace depthscope::slam {
namespace {

constexpr int kWidth = 640, kHeight = 480;

ImagePyramid pyramidOf(const ImageBuffer& image) {
  ImagePyramid pyramid(image.width(), image.height(), 8, 1.2);
  pyramid.build(image.view(), SimdPath::Portable);
  return pyramid;
}

double dim(double x, double y) {
  return 60 + 0.25 * testing::TissueTexture(7)(x, y);
}

TEST(CellDistance, IsTheDistanceToTheNearestMarkedCell) {
  CellDistance distance(200, 120, 4);
  std::mt19937 rng(3);
  std::vector<std::pair<int, int>> marked;
  for (int i = 0; i < 12; ++i) {
    marked.emplace_back(rng() % distance.columns(), rng() % distance.rows());
    distance.mark(marked.back().first, marked.back().second);
  }
  distance.propagate();
  for (int r = 0; r < distance.rows(); ++r)
    for (int c = 0; c < distance.columns(); ++c) {
      double nearest = 1e9;
      for (const auto& [mc, mr] : marked) nearest = std::min(nearest, std::hypot(c - mc, r - mr));
      EXPECT_NEAR(distance.at(c * 4 + 1, r * 4 + 1), nearest * 4, 0.09 * nearest * 4);
    }
}

TEST(CellDistance, IsFarWhereNothingIsMarked) {
  CellDistance distance(200, 120, 4);
  distance.propagate();
  EXPECT_GE(distance.at(100, 60), 300);
}

TEST(HighlightMask, FindsWhatStandsOutFromTheTissueAroundIt) {
  const ImageBuffer image = testing::draw(kWidth, kHeight, [](double x, double y) {
    return dim(x, y) + (std::hypot(x - 200, y - 150) < 6 ? 80 : 0);
  });
  const ImagePyramid pyramid = pyramidOf(image);
  HighlightMask mask(pyramid, {});
  mask.update(pyramid, 24);
  EXPECT_EQ(mask.distance(200, 150), 0);
  EXPECT_NEAR(mask.distance(240, 150), 34, 6);
  EXPECT_GT(mask.distance(500, 400), 100);
}

TEST(HighlightMask, LetsBrightTissueBe) {
  // Twice as bright on the right half, slowly.
  const ImageBuffer image = testing::draw(kWidth, kHeight, [](double x, double y) {
    return dim(x, y) * (1.5 + 0.5 * std::tanh((x - 320) / 150));
  });
  const ImagePyramid pyramid = pyramidOf(image);
  HighlightMask mask(pyramid, {});
  mask.update(pyramid, 24);
  for (int y = 0; y < kHeight; y += 20)
    for (int x = 0; x < kWidth; x += 20) EXPECT_GT(mask.distance(x, y), 0);
}

TEST(HighlightMask, FindsWhatIsSaturatedHoweverBrightItsSurroundings) {
  const ImageBuffer image = testing::draw(kWidth, kHeight, [](double x, double y) {
    return std::hypot(x - 300, y - 300) < 8 ? 240 : 200 + 0.05 * testing::TissueTexture(1)(x, y);
  });
  const ImagePyramid pyramid = pyramidOf(image);
  HighlightMask mask(pyramid, {});
  mask.update(pyramid, 24);
  EXPECT_EQ(mask.distance(300, 300), 0);
  EXPECT_GT(mask.distance(100, 100), 100);
}

/// A round view of radius 200 in black, with text in a corner and a dark hole in its middle.
ImageBuffer roundView() {
  return testing::draw(kWidth, kHeight, [](double x, double y) {
    if (x > 20 && x < 80 && y > 20 && y < 40) return 200.0;
    if (std::hypot(x - 320, y - 240) > 200) return 12.0;
    return std::hypot(x - 320, y - 240) < 40 ? 10.0 : dim(x, y);
  });
}

TEST(FieldOfView, IsTheRoundViewWithoutTextAndWithItsDarkMiddle) {
  const ImagePyramid pyramid = pyramidOf(roundView());
  FieldOfView view(pyramid);
  view.update(pyramid, 24);
  EXPECT_EQ(view.distance(50, 30), 0);    // text
  EXPECT_EQ(view.distance(600, 400), 0);  // surroundings
  EXPECT_NEAR(view.distance(320, 240), 200, 18);
  EXPECT_NEAR(view.distance(320 + 150, 240), 50, 10);
  EXPECT_NEAR(view.bounds().left, 120, 10);
  EXPECT_NEAR(view.bounds().right, 520, 10);
  EXPECT_NEAR(view.bounds().top, 40, 10);
  EXPECT_NEAR(view.bounds().bottom, 440, 10);
}

TEST(FieldOfView, IsTheWholePictureWhereNothingIsDarkAtItsBorder) {
  const ImagePyramid round = pyramidOf(roundView());
  const ImagePyramid full = pyramidOf(testing::draw(kWidth, kHeight, [](double x, double y) {
    return std::hypot(x - 320, y - 240) < 60 ? 5 : dim(x, y);
  }));
  FieldOfView view(round);
  view.update(round, 24);
  view.update(full, 24);
  EXPECT_GT(view.distance(3, 3), 100);
  EXPECT_EQ(view.bounds().right, kWidth);
}

TEST(FieldOfView, IsEmptyInADarkPicture) {
  const ImagePyramid dark =
      pyramidOf(testing::draw(kWidth, kHeight, [](double, double) { return 5; }));
  FieldOfView view(dark);
  view.update(dark, 24);
  EXPECT_EQ(view.distance(320, 240), 0);
  EXPECT_LE(view.bounds().right, view.bounds().left);
}

/// Ends of an outline are `tolerance` [px] from where they are in a round view of radius 200 in the
/// middle, but for its flat top and bottom; above and below nothing is seen.
void expectRound(const ViewOutline& outline, double tolerance) {
  for (int band = 0; band < ViewOutline::bands; ++band) {
    const double y = std::floor((band + 0.5) * kHeight / ViewOutline::bands);
    const double half2 = 200.0 * 200.0 - (y - 240) * (y - 240);
    const ViewOutline::Span& span = outline.spans[static_cast<std::size_t>(band)];
    if (half2 < 0) {
      EXPECT_TRUE(span.empty()) << y;
    } else if (half2 > 60 * 60) {
      EXPECT_NEAR(span.left, 320 - std::sqrt(half2) + 3.5, tolerance) << y;
      EXPECT_NEAR(span.right, 320 + std::sqrt(half2) - 3.5, tolerance) << y;
    }
  }
}

TEST(FieldOfView, ItsOutlineLiesInsideTheRoundViewAndCloseToItsEdge) {
  const ImagePyramid pyramid = pyramidOf(roundView());
  FieldOfView view(pyramid);
  view.update(pyramid, 24);
  expectRound(view.outline(pyramid), 2.5);
}

TEST(FieldOfView, NoiseBesideADimViewIsNoPartOfIt) {
  std::mt19937 rng(5);
  const ImagePyramid pyramid = pyramidOf(testing::draw(kWidth, kHeight, [&](double x, double y) {
    const bool lit = std::hypot(x - 320, y - 240) < 200;
    return (lit ? 40.0 : 10.0) + static_cast<double>(rng() % 24);
  }));
  FieldOfView view(pyramid);
  view.update(pyramid, 32);
  expectRound(view.outline(pyramid), 2.5);
}

/// On one side it ends with the picture, on the other, a few pixels on, by itself.
TEST(FieldOfView, AnOutlineMayBeASliverAtTheBorder) {
  for (const bool at_left : {true, false}) {
    const ImagePyramid pyramid = pyramidOf(testing::draw(kWidth, kHeight, [&](double x, double y) {
      return (at_left ? x < 12 : x > kWidth - 13) ? dim(x, y) : 5;
    }));
    FieldOfView view(pyramid);
    view.update(pyramid, 24);
    const ViewOutline::Span span = view.outline(pyramid).spans[ViewOutline::bands / 2];
    ASSERT_FALSE(span.empty());
    EXPECT_EQ(span.left == -ViewOutline::beyond, at_left);
    EXPECT_EQ(span.right == ViewOutline::beyond, !at_left);
    if (at_left)
      EXPECT_NEAR(span.right, 12 - 2.9, 1.5);
    else
      EXPECT_NEAR(span.left, kWidth - 12 + 2.9, 1.5);
  }
}

TEST(FieldOfView, WithoutSurroundingsTheOutlineIsThePicturesBorder) {
  const ImagePyramid full = pyramidOf(testing::draw(kWidth, kHeight, dim));
  FieldOfView view(full);
  view.update(full, 24);
  EXPECT_EQ(view.outline(full), ViewOutline());
}

}  // namespace
}  // namespace depthscope::slam
