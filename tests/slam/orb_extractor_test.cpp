#include "slam/orb_extractor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>

#include "tests/slam/allocation_counter.hpp"
#include "tests/slam/tissue_picture.hpp"
#include "types/allocation_scope.hpp"

namespace depthscope::slam {
namespace {

constexpr int kWidth = 640, kHeight = 480;

CameraModel pinhole() {
  CameraModel camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 450;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

/// Texture of low contrast, so that highlights are not seen in it.
double tissue(double x, double y) {
  return 75 + 0.3 * testing::TissueTexture(21)(x, y);
}

/// So that a keypoint's sigma is the size of its pixels.
ExtractorSettings unitSigma() {
  ExtractorSettings settings;
  settings.keypoint_sigma_px = 1;
  return settings;
}

FeatureSet extract(const ImageBuffer& image, const CameraModel& camera = pinhole(),
                   SimdPath path = bestSimdPath()) {
  OrbExtractor extractor(unitSigma(), camera, path);
  FeatureSet features(ExtractorSettings{}.features, camera);
  extractor.extract(image.view(), features);
  return features;
}

void expectSame(const FeatureSet& a, const FeatureSet& b) {
  ASSERT_EQ(a.size(), b.size());
  for (int i = 0; i < a.size(); ++i) {
    const Keypoint &p = a.keypoints[i], &q = b.keypoints[i];
    const std::array<float, 7> u{p.x, p.y, p.ux, p.uy, p.sigma, p.angle, p.response};
    const std::array<float, 7> v{q.x, q.y, q.ux, q.uy, q.sigma, q.angle, q.response};
    EXPECT_EQ(std::memcmp(&u, &v, sizeof u), 0) << "keypoint " << i;
    EXPECT_EQ(p.octave, q.octave);
    EXPECT_EQ(a.descriptors[i], b.descriptors[i]);
  }
}

struct Agreement {
  double repeated = 0;  // share of keypoints with one near the place expected, sizes agreeing
  double matched = 0;   // share whose nearest descriptor is at the place expected
  double error_px = 0;  // root mean square of these, each axis, in pixels of the octave
};

/// `map` takes a place of picture a into picture b, lengths times `scale`.
Agreement compare(const FeatureSet& a, const FeatureSet& b, double scale,
                  const std::function<Eigen::Vector2d(double, double)>& map) {
  Agreement agreement;
  int expected = 0;
  double squares = 0;
  for (int i = 0; i < a.size(); ++i) {
    const Keypoint& k = a.keypoints[i];
    const Eigen::Vector2d place = map(k.x, k.y);
    const double size = k.sigma * scale;
    if (place.x() < 70 || place.y() < 70 || place.x() > kWidth - 70 || place.y() > kHeight - 70)
      continue;
    ++expected;
    const auto distanceTo = [&](int j) {
      return std::hypot(b.keypoints[j].x - place.x(), b.keypoints[j].y - place.y()) / size;
    };
    bool repeated = false;
    int nearest = -1, nearest_bits = 257;
    for (int j = 0; j < b.size(); ++j) {
      const double ratio = b.keypoints[j].sigma / size;
      repeated = repeated || (distanceTo(j) < 1.5 && ratio > 0.7 && ratio < 1.4);
      const int bits = hammingDistance(a.descriptors[i], b.descriptors[j]);
      if (bits < nearest_bits) {
        nearest_bits = bits;
        nearest = j;
      }
    }
    agreement.repeated += repeated;
    if (distanceTo(nearest) > 3) continue;
    agreement.matched += 1;
    squares += std::pow(distanceTo(nearest), 2);
  }
  agreement.error_px = std::sqrt(squares / (2 * agreement.matched));
  agreement.repeated /= expected;
  agreement.matched /= expected;
  return agreement;
}

TEST(OrbExtractor, FindsAsManyFeaturesAsAskedFor) {
  const FeatureSet features = extract(testing::draw(kWidth, kHeight, tissue));
  EXPECT_EQ(features.size(), 1000);
  EXPECT_EQ(features.descriptors.size(), features.keypoints.size());
}

TEST(OrbExtractor, FindsMoreWhereMoreAreWanted) {
  const ImageBuffer image = testing::draw(kWidth, kHeight, tissue);
  OrbExtractor extractor(unitSigma(), pinhole());
  FeatureSet features(ExtractorSettings{}.capacity(), pinhole());
  for (const int wanted : {300, 1500}) {
    extractor.extract(image.view(), wanted, features);
    EXPECT_EQ(features.size(), wanted);
  }
}

TEST(OrbExtractor, LowersItsThresholdsWhereThereIsLittleTexture) {
  const ImageBuffer image = testing::draw(kWidth, kHeight, [](double x, double y) {
    return 100 + 0.14 * testing::TissueTexture(22)(x, y);
  });
  // Halved twice, these are the thresholds that the default settings try first.
  ExtractorSettings strict;
  strict.fast_threshold *= 4;
  strict.fast_threshold_min *= 4;
  OrbExtractor extractor(strict, pinhole());
  FeatureSet few(strict.features, pinhole());
  extractor.extract(image.view(), few);
  EXPECT_LT(few.size(), 500);
  EXPECT_GT(extract(image).size(), 700);
}

TEST(OrbExtractor, SpreadsFeaturesOverPictureAndScale) {
  const FeatureSet features = extract(testing::draw(kWidth, kHeight, tissue));
  std::array<int, 16> cells{};
  std::array<int, 8> octaves{};
  for (const Keypoint& k : features.keypoints) {
    ++cells[static_cast<int>(k.y * 4 / kHeight) * 4 + static_cast<int>(k.x * 4 / kWidth)];
    ++octaves[k.octave];
  }
  for (const int n : cells) EXPECT_GT(n, 25);
  for (const int n : octaves) EXPECT_GT(n, 30);
}

/// All of it darker than a fixed level of surroundings would be.
TEST(OrbExtractor, FindsDimTissueUpToThePicturesBorder) {
  const FeatureSet features = extract(testing::draw(kWidth, kHeight, [](double x, double y) {
    return 8 + 0.12 * testing::TissueTexture(21)(x, y);
  }));
  EXPECT_GT(features.size(), 500);
  std::array<int, 16> cells{};
  for (const Keypoint& k : features.keypoints)
    ++cells[static_cast<int>(k.y * 4 / kHeight) * 4 + static_cast<int>(k.x * 4 / kWidth)];
  for (const int n : cells) EXPECT_GT(n, 10);
}

TEST(OrbExtractor, FindsTheSameTissueTurnedAndShifted) {
  const double angle = 0.6, c = std::cos(angle), s = std::sin(angle);
  const FeatureSet a = extract(testing::draw(kWidth, kHeight, tissue));
  const FeatureSet b = extract(testing::draw(kWidth, kHeight, [&](double x, double y) {
    const double u = x - 320, v = y - 240;
    return tissue(c * u + s * v + 320, -s * u + c * v + 240);
  }));
  const Agreement agreement = compare(a, b, 1, [&](double x, double y) {
    const double u = x - 320, v = y - 240;
    return Eigen::Vector2d(c * u - s * v + 320, s * u + c * v + 240);
  });
  EXPECT_GT(agreement.repeated, 0.7);
  EXPECT_GT(agreement.matched, 0.6);
  EXPECT_LT(agreement.error_px, 0.5);
}

TEST(OrbExtractor, FindsTheSameTissueNearer) {
  const FeatureSet a = extract(testing::draw(kWidth, kHeight, tissue));
  const FeatureSet b = extract(testing::draw(kWidth, kHeight, [&](double x, double y) {
    return tissue((x - 320) / 1.44 + 320, (y - 240) / 1.44 + 240);
  }));
  const Agreement agreement = compare(a, b, 1.44, [&](double x, double y) {
    return Eigen::Vector2d((x - 320) * 1.44 + 320, (y - 240) * 1.44 + 240);
  });
  EXPECT_GT(agreement.repeated, 0.5);
  EXPECT_GT(agreement.matched, 0.35);
  EXPECT_LT(agreement.error_px, 0.6);
}

TEST(OrbExtractor, FindsTheSameTissueInOtherLight) {
  const FeatureSet a = extract(testing::draw(kWidth, kHeight, tissue));
  const FeatureSet b = extract(
      testing::draw(kWidth, kHeight, [&](double x, double y) { return 0.7 * tissue(x, y) + 20; }));
  const Agreement agreement =
      compare(a, b, 1, [](double x, double y) { return Eigen::Vector2d(x, y); });
  EXPECT_GT(agreement.repeated, 0.7);
  EXPECT_GT(agreement.matched, 0.6);
  EXPECT_LT(agreement.error_px, 0.35);
}

TEST(OrbExtractor, FindsNothingOnHighlightsOrAcrossTheEdgeOfTheView) {
  const auto onHighlight = [](double x, double y, double r) {
    return std::hypot(x - 250, y - 200) < r || std::hypot(x - 400, y - 300) < r;
  };
  const FeatureSet features = extract(testing::draw(kWidth, kHeight, [&](double x, double y) {
    if (std::hypot(x - 320, y - 240) > 210) return 10.0;
    return onHighlight(x, y, 12) ? 240.0 : tissue(x, y);
  }));
  EXPECT_GT(features.size(), 500);
  for (const Keypoint& k : features.keypoints) {
    EXPECT_FALSE(onHighlight(k.x, k.y, 12 + 2 * k.sigma));
    EXPECT_LT(std::hypot(k.x - 320, k.y - 240), 210 - 14 * k.sigma + 10);
  }
}

TEST(OrbExtractor, UndistortsAndTellsTheDeviationThere) {
  CameraModel camera = pinhole();
  camera.k = {-0.28, 0.07, 0, 0, 0};
  const FeatureSet features = extract(testing::draw(kWidth, kHeight, tissue), camera);
  bool magnified = false;
  for (const Keypoint& k : features.keypoints) {
    const Eigen::Vector2d u = camera.toPixel(camera.unproject({k.x, k.y}));
    EXPECT_LT(std::hypot(k.ux - u.x(), k.uy - u.y()), 0.02);
    const double magnification = k.sigma / std::pow(1.2, k.octave);
    EXPECT_GE(magnification, 0.99);
    magnified = magnified || magnification > 1.2;
  }
  EXPECT_TRUE(magnified);
}

TEST(OrbExtractor, FillsTheGridWithItsKeypoints) {
  const FeatureSet features = extract(testing::draw(kWidth, kHeight, tissue));
  std::array<std::uint32_t, 16> found{};
  for (int i = 0; i < features.size(); i += 50) {
    const Keypoint& k = features.keypoints[i];
    const int n = features.grid.query(k.ux, k.uy, 0.01F, k.octave, k.octave, found);
    EXPECT_NE(std::find(found.begin(), found.begin() + n, static_cast<std::uint32_t>(i)),
              found.begin() + n);
  }
}

TEST(OrbExtractor, GivesTheSameOnEveryPath) {
  if (!isAvailable(SimdPath::Avx2)) GTEST_SKIP() << "not on this processor";
  const ImageBuffer image = testing::draw(kWidth, kHeight, tissue);
  expectSame(extract(image, pinhole(), SimdPath::Portable),
             extract(image, pinhole(), SimdPath::Avx2));
}

TEST(OrbExtractor, GivesTheSameForAPictureWhateverCameBefore) {
  const ImageBuffer image = testing::draw(kWidth, kHeight, tissue);
  const ImageBuffer other = testing::draw(kWidth, kHeight, [](double x, double y) {
    return std::hypot(x - 320, y - 240) > 180 ? 10 : testing::TissueTexture(5)(x, y);
  });
  OrbExtractor extractor(unitSigma(), pinhole());
  FeatureSet features(1000, pinhole());
  extractor.extract(other.view(), features);
  extractor.extract(image.view(), features);
  expectSame(features, extract(image));
}

TEST(OrbExtractor, AllocatesNothing) {
  const ImageBuffer image = testing::draw(kWidth, kHeight, tissue);
  const ImageBuffer noise = testing::draw(kWidth, kHeight, [](double x, double y) {
    return 120 + 100 * std::sin(1e4 * std::sin(x * 12.9898 + y * 78.233));
  });
  OrbExtractor extractor(unitSigma(), pinhole());
  FeatureSet features(1000, pinhole());
  testing::takeAllocationCount();
  {
    const AllocationScope scope;
    extractor.extract(image.view(), features);
    extractor.extract(noise.view(), features);
  }
  EXPECT_EQ(testing::takeAllocationCount(), 0);
}

TEST(OrbExtractor, FindsNothingInAPictureOfAnotherSizeOrNone) {
  OrbExtractor extractor(unitSigma(), pinhole());
  FeatureSet features(1000, pinhole());
  extractor.extract(testing::draw(kWidth, kHeight, tissue).view(), features);
  EXPECT_GT(features.size(), 0);
  extractor.extract(testing::draw(320, 240, tissue).view(), features);
  EXPECT_EQ(features.size(), 0);
  extractor.extract({}, features);
  EXPECT_EQ(features.size(), 0);
}

TEST(OrbExtractor, WorksOnPicturesTooSmallForTheirPyramid) {
  CameraModel camera = pinhole();
  camera.width = 64;
  camera.height = 40;
  const FeatureSet features = extract(testing::draw(64, 40, tissue), camera);
  for (const Keypoint& k : features.keypoints) EXPECT_LT(k.octave, 2);
}

}  // namespace
}  // namespace depthscope::slam
