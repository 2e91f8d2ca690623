#include "capture/pixel_convert.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace depthscope::capture {
namespace {

using Rgb = std::array<int, 3>;

/// ITU-R BT.601-7 and BT.709-6 in double precision.
Rgb referenceRgb(int y, int u, int v, YuvMatrix matrix, YuvRange range) {
  const double kr = std::array{0.299, 0.2126, 0.2627}[static_cast<int>(matrix)];
  const double kb = std::array{0.114, 0.0722, 0.0593}[static_cast<int>(matrix)];
  const bool limited = range == YuvRange::Limited;
  const double luma = limited ? (y - 16) / 219.0 : y / 255.0;
  const double pb = (u - 128) / (limited ? 224.0 : 255.0);
  const double pr = (v - 128) / (limited ? 224.0 : 255.0);
  const double r = luma + 2 * (1 - kr) * pr;
  const double b = luma + 2 * (1 - kb) * pb;
  const double g = (luma - kr * r - kb * b) / (1 - kr - kb);
  const auto level = [](double x) {
    return static_cast<int>(std::lround(std::clamp(x, 0.0, 1.0) * 255));
  };
  return {level(r), level(g), level(b)};
}

Frame makeFrame(const FrameFormat& format) {
  return FramePool::create(format, 1)->acquire();
}

std::uint8_t& at(const Frame& frame, int plane, int x, int y) {
  return frame.planes[plane].data[y * frame.planes[plane].stride + x];
}

std::vector<std::uint8_t> rgbaOf(const Frame& frame) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(frame.format.width) * frame.format.height *
                                4);
  toRgba(frame, out);
  return out;
}

std::vector<std::uint8_t> grayOf(const Frame& frame) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(frame.format.width) * frame.format.height);
  toGray(frame, out);
  return out;
}

struct Standard {
  YuvMatrix matrix;
  YuvRange range;
};
class YuvToRgba : public testing::TestWithParam<Standard> {};

/// Every Y against a grid of U and V: rows of one U, V pair each, every Y twice a row.
TEST_P(YuvToRgba, IsWithinOneLevelOfTheExactConversion) {
  const auto [matrix, range] = GetParam();
  std::int64_t off = 0, count = 0;
  const Frame frame = makeFrame({PixelFormat::Yuv420p, 512, 2 * 52, matrix, range});
  std::vector<std::uint8_t> out(512 * 2 * 52 * 4);
  for (int y = 0; y < frame.format.height; ++y)
    for (int x = 0; x < 512; ++x) at(frame, 0, x, y) = static_cast<std::uint8_t>(x / 2);
  for (int u = 0; u < 256; u += 5) {
    for (int i = 0; i < 52; ++i)
      for (int x = 0; x < 256; ++x) {
        at(frame, 1, x, i) = static_cast<std::uint8_t>(u);
        at(frame, 2, x, i) = static_cast<std::uint8_t>(i * 5);
      }
    toRgba(frame, out);
    for (int y = 0; y < frame.format.height; ++y)
      for (int x = 0; x < 512; x += 2) {
        const Rgb expected = referenceRgb(x / 2, u, y / 2 * 5, matrix, range);
        const std::uint8_t* pixel = &out[4 * (y * 512 + x)];
        for (int c = 0; c < 3; ++c, ++count) {
          const int error = std::abs(pixel[c] - expected[c]);
          ASSERT_LE(error, 1) << "Y " << x / 2 << " U " << u << " V " << y / 2 * 5;
          off += error != 0;
        }
        ASSERT_EQ(pixel[3], 255);
      }
  }
  EXPECT_LT(static_cast<double>(off), 2e-3 * static_cast<double>(count))
      << "not rounded to nearest";
}

INSTANTIATE_TEST_SUITE_P(AllStandards, YuvToRgba,
                         testing::Values(Standard{YuvMatrix::Bt601, YuvRange::Limited},
                                         Standard{YuvMatrix::Bt601, YuvRange::Full},
                                         Standard{YuvMatrix::Bt709, YuvRange::Limited},
                                         Standard{YuvMatrix::Bt709, YuvRange::Full},
                                         Standard{YuvMatrix::Bt2020, YuvRange::Limited},
                                         Standard{YuvMatrix::Bt2020, YuvRange::Full}));

TEST(ToRgba, KnowsTheColourBars) {
  struct Bar {
    YuvMatrix matrix;
    int y, u, v;
    Rgb rgb;
  };
  // 100 % bars as studio equipment gives them, limited range.
  const std::vector<Bar> bars{{YuvMatrix::Bt601, 235, 128, 128, {255, 255, 255}},
                              {YuvMatrix::Bt601, 16, 128, 128, {0, 0, 0}},
                              {YuvMatrix::Bt601, 81, 90, 240, {255, 0, 0}},
                              {YuvMatrix::Bt601, 145, 54, 34, {0, 255, 0}},
                              {YuvMatrix::Bt601, 41, 240, 110, {0, 0, 255}},
                              {YuvMatrix::Bt709, 63, 102, 240, {255, 0, 0}},
                              {YuvMatrix::Bt709, 173, 42, 26, {0, 255, 0}},
                              {YuvMatrix::Bt709, 32, 240, 118, {0, 0, 255}}};
  for (const Bar& bar : bars) {
    const Frame frame = makeFrame({PixelFormat::Yuv420p, 2, 2, bar.matrix, YuvRange::Limited});
    for (int i = 0; i < 4; ++i) at(frame, 0, i % 2, i / 2) = static_cast<std::uint8_t>(bar.y);
    at(frame, 1, 0, 0) = static_cast<std::uint8_t>(bar.u);
    at(frame, 2, 0, 0) = static_cast<std::uint8_t>(bar.v);
    const auto out = rgbaOf(frame);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(out[c], bar.rgb[c], 1)
          << "Y " << bar.y << " channel " << c;  // bars are 8-bit too
  }
}

/// Where a format keeps one of the samples of pixel x, y: component 0 is Y, 1 is U, 2 is V.
std::uint8_t& sample(const Frame& frame, int component, int x, int y) {
  switch (frame.format.pixel_format) {
    case PixelFormat::Yuv420p:
      return component == 0 ? at(frame, 0, x, y) : at(frame, component, x / 2, y / 2);
    case PixelFormat::Yuv422p:
      return component == 0 ? at(frame, 0, x, y) : at(frame, component, x / 2, y);
    case PixelFormat::Nv12:
      return component == 0 ? at(frame, 0, x, y) : at(frame, 1, x / 2 * 2 + component - 1, y / 2);
    case PixelFormat::Nv16:
      return component == 0 ? at(frame, 0, x, y) : at(frame, 1, x / 2 * 2 + component - 1, y);
    case PixelFormat::Yuyv:
      return at(frame, 0, component == 0 ? 2 * x : x / 2 * 4 + 2 * component - 1, y);
    case PixelFormat::Uyvy:
      return at(frame, 0, component == 0 ? 2 * x + 1 : x / 2 * 4 + 2 * component - 2, y);
    default:
      return at(frame, component, x, y);
  }
}

class YuvLayout : public testing::TestWithParam<PixelFormat> {};

TEST_P(YuvLayout, TakesChromaOfTheNearestSampleInOddPictures) {
  // Wider than a block of the row function, so that block borders are crossed.
  const Frame frame = makeFrame({GetParam(), 1037, 5, YuvMatrix::Bt709, YuvRange::Full});
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 1037; ++x) {
      sample(frame, 0, x, y) = static_cast<std::uint8_t>(x * 5 + y);
      sample(frame, 1, x, y) = static_cast<std::uint8_t>(x * 3 + y * 50);
      sample(frame, 2, x, y) = static_cast<std::uint8_t>(255 - x * 7 - y);
    }
  const auto out = rgbaOf(frame);
  const auto gray = grayOf(frame);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 1037; ++x) {
      const Rgb expected = referenceRgb(sample(frame, 0, x, y), sample(frame, 1, x, y),
                                        sample(frame, 2, x, y), YuvMatrix::Bt709, YuvRange::Full);
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(out[4 * (y * 1037 + x) + c], expected[c], 1) << x << ", " << y;
      ASSERT_EQ(out[4 * (y * 1037 + x) + 3], 255);
      ASSERT_EQ(gray[y * 1037 + x], sample(frame, 0, x, y));
    }
}

INSTANTIATE_TEST_SUITE_P(AllLayouts, YuvLayout,
                         testing::Values(PixelFormat::Yuv420p, PixelFormat::Yuv422p,
                                         PixelFormat::Yuv444p, PixelFormat::Nv12, PixelFormat::Nv16,
                                         PixelFormat::Yuyv, PixelFormat::Uyvy));

TEST(ToRgba, HandsRgbOnUnchangedAndOpaque) {
  for (const PixelFormat format :
       {PixelFormat::Rgb24, PixelFormat::Bgr24, PixelFormat::Rgba32, PixelFormat::Bgrx32}) {
    const Frame frame = makeFrame({format, 37, 3, YuvMatrix::Bt601, YuvRange::Full});
    const int bytes = planeSize(frame.format, 0).row_bytes / 37;
    const bool swapped = format == PixelFormat::Bgr24 || format == PixelFormat::Bgrx32;
    for (int y = 0; y < 3; ++y)
      for (int i = 0; i < 37 * bytes; ++i)
        at(frame, 0, i, y) = static_cast<std::uint8_t>(i * 3 + y);
    const auto out = rgbaOf(frame);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 37; ++x) {
        for (int c = 0; c < 3; ++c)
          ASSERT_EQ(out[4 * (y * 37 + x) + c], at(frame, 0, x * bytes + (swapped ? 2 - c : c), y));
        ASSERT_EQ(out[4 * (y * 37 + x) + 3], 255);
      }
  }
}

TEST(ToRgba, ExpandsRgbOfLimitedRange) {
  const Frame frame = makeFrame({PixelFormat::Bgrx32, 256, 1, YuvMatrix::Bt601, YuvRange::Limited});
  for (int i = 0; i < 4 * 256; ++i) at(frame, 0, i, 0) = static_cast<std::uint8_t>(i / 4);
  const auto out = rgbaOf(frame);
  for (int x = 0; x < 256; ++x) {
    for (int c = 0; c < 3; ++c)
      ASSERT_EQ(out[4 * x + c], referenceRgb(x, 128, 128, YuvMatrix::Bt601, YuvRange::Limited)[c])
          << x;
    ASSERT_EQ(out[4 * x + 3], 255);
  }
}

TEST(ToRgba, ExpandsGrayByItsRange) {
  for (const YuvRange range : {YuvRange::Full, YuvRange::Limited}) {
    const Frame frame = makeFrame({PixelFormat::Gray8, 256, 1, YuvMatrix::Bt601, range});
    for (int x = 0; x < 256; ++x) at(frame, 0, x, 0) = static_cast<std::uint8_t>(x);
    const auto out = rgbaOf(frame);
    for (int x = 0; x < 256; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(out[4 * x + c], referenceRgb(x, 128, 128, YuvMatrix::Bt601, range)[c]) << x;
  }
}

TEST(ToGray, IsGrayAsItIs) {
  const Frame frame = makeFrame({PixelFormat::Gray8, 35, 3});
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 35; ++x) at(frame, 0, x, y) = static_cast<std::uint8_t>(x * 7 + y);
  const auto gray = grayOf(frame);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 35; ++x) ASSERT_EQ(gray[y * 35 + x], at(frame, 0, x, y));
}

TEST(ToGray, WeighsRgbByBt601) {
  for (const PixelFormat format :
       {PixelFormat::Rgb24, PixelFormat::Bgr24, PixelFormat::Rgba32, PixelFormat::Bgrx32}) {
    const Frame frame = makeFrame({format, 64, 64});
    const int bytes = planeSize(frame.format, 0).row_bytes / 64;
    const bool swapped = format == PixelFormat::Bgr24 || format == PixelFormat::Bgrx32;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        at(frame, 0, x * bytes + (swapped ? 2 : 0), y) = static_cast<std::uint8_t>(x * 4);
        at(frame, 0, x * bytes + 1, y) = static_cast<std::uint8_t>(y * 4);
        at(frame, 0, x * bytes + (swapped ? 0 : 2), y) =
            static_cast<std::uint8_t>(255 - 2 * (x + y));
      }
    const auto gray = grayOf(frame);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        ASSERT_NEAR(gray[y * 64 + x],
                    0.299 * (x * 4) + 0.587 * (y * 4) + 0.114 * (255 - 2 * (x + y)), 0.51);
  }
}

TEST(Convert, LeavesABufferThatIsTooSmallAlone) {
  const Frame frame = makeFrame({PixelFormat::Gray8, 8, 8});
  std::vector<std::uint8_t> rgba(8 * 8 * 4 - 1, 77), gray(8 * 8 - 1, 77);
  toRgba(frame, rgba);
  toGray(frame, gray);
  EXPECT_EQ(std::count(rgba.begin(), rgba.end(), 77), 255);
  EXPECT_EQ(std::count(gray.begin(), gray.end(), 77), 63);
  toRgba(Frame(), rgba);
  EXPECT_EQ(rgba[0], 77);
}

TEST(ToReducedRgb, IsTheMeanOfARunInTheMiddleOfEachSquare) {
  const Frame frame = makeFrame({PixelFormat::Rgb24, 484, 361});  // reduced by 3, edges cut off
  for (int y = 0; y < 361; ++y)
    for (int x = 0; x < 484; ++x)
      for (int c = 0; c < 3; ++c)
        at(frame, 0, 3 * x + c, y) = static_cast<std::uint8_t>((x * (c + 1) + 5 * y) % 250);
  const ColorReduction size(484, 361);
  ASSERT_EQ(size.factor, 3);
  ASSERT_EQ(size.width, 161);
  ASSERT_EQ(size.height, 120);
  const std::vector<std::uint8_t> whole = rgbaOf(frame);
  std::vector<depthscope::Rgb> out(size.pixels());
  toReducedRgb(frame, out);
  for (const auto& [x, y] : {std::pair{0, 0}, {7, 11}, {160, 119}})
    for (int c = 0; c < 3; ++c) {
      int sum = 0;
      for (int i = 0; i < 3; ++i)
        sum += whole[static_cast<std::size_t>(((3 * y + 1) * 484 + 3 * x + i) * 4 + c)];
      EXPECT_EQ(out[static_cast<std::size_t>(y * 161 + x)][static_cast<std::size_t>(c)],
                (sum + 1) / 3);
    }
}

TEST(ToReducedRgb, HasTheColoursOfTheWholePictureInEveryFormat) {
  for (int f = 0; f < kPixelFormats - 1; ++f) {
    const Frame frame = makeFrame({static_cast<PixelFormat>(f), 320, 240, YuvMatrix::Bt709});
    for (int p = 0; p < planeCount(frame.format.pixel_format); ++p) {
      const PlaneSize plane = planeSize(frame.format, p);
      for (int y = 0; y < plane.rows; ++y)
        for (int x = 0; x < plane.row_bytes; ++x)
          at(frame, p, x, y) = static_cast<std::uint8_t>(80 + 30 * p + 20 * (x % 4));
    }
    const std::vector<std::uint8_t> whole = rgbaOf(frame);
    std::vector<depthscope::Rgb> out(ColorReduction(320, 240).pixels());
    toReducedRgb(frame, out);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(out[0][c], (whole[4 * 320 + c] + whole[4 * 320 + 4 + c]) / 2, 1) << f;
  }
}

TEST(ToReducedRgb, LeavesWhatIsTooSmallAlone) {
  std::vector<depthscope::Rgb> out(3, {1, 2, 3});
  toReducedRgb(makeFrame({PixelFormat::Gray8, 16, 16}), out);
  toReducedRgb(Frame(), out);
  EXPECT_EQ(out[2], (depthscope::Rgb{1, 2, 3}));
}

}  // namespace
}  // namespace depthscope::capture
