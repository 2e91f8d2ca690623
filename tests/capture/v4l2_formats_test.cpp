#include "tests/capture/v4l2_test_card.hpp"

namespace depthscope::capture {
namespace {

struct Case {
  __u32 fourcc;
  bool multiplanar;
  PixelFormat format;
};

class V4l2Formats : public V4l2Test, public testing::WithParamInterface<Case> {};

/// Lines longer than need be, an offset before the picture, moving bars: every sample has to come
/// from its own place.
TEST_P(V4l2Formats, EveryPixelIsWhatTheCameraSaw) {
  const Case c = GetParam();
  FakeV4l2Card::Options options;
  options.multiplanar = c.multiplanar;
  options.formats = {c.fourcc};
  options.padding = 24;
  options.data_offset = c.multiplanar ? 64 : 0;
  plug(options);
  open();
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Frame frame = nextPicture();
    ASSERT_FALSE(frame.empty()) << source->detail();
    EXPECT_EQ(frame.format.pixel_format, c.format);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_LE(farthest(frame,
                       [&](int x, int y) {
                         if (c.format != PixelFormat::Gray8) return bars(x, y, i, 0);
                         const Rgb b = bars(x, y, i, 0);
                         const double luma = 0.2126 * b.r + 0.7152 * b.g + 0.0722 * b.b;
                         return Rgb{luma, luma, luma};
                       }),
              2.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, V4l2Formats,
                         testing::Values(Case{V4L2_PIX_FMT_YUYV, false, PixelFormat::Yuyv},
                                         Case{V4L2_PIX_FMT_UYVY, false, PixelFormat::Uyvy},
                                         Case{V4L2_PIX_FMT_NV12, false, PixelFormat::Nv12},
                                         Case{V4L2_PIX_FMT_NV16, false, PixelFormat::Nv16},
                                         Case{V4L2_PIX_FMT_YUV420, false, PixelFormat::Yuv420p},
                                         Case{V4L2_PIX_FMT_YUV422P, false, PixelFormat::Yuv422p},
                                         Case{V4L2_PIX_FMT_BGR24, false, PixelFormat::Bgr24},
                                         Case{V4L2_PIX_FMT_RGB24, false, PixelFormat::Rgb24},
                                         Case{V4L2_PIX_FMT_XBGR32, false, PixelFormat::Bgrx32},
                                         Case{V4L2_PIX_FMT_GREY, false, PixelFormat::Gray8},
                                         Case{V4L2_PIX_FMT_YUYV, true, PixelFormat::Yuyv},
                                         Case{V4L2_PIX_FMT_NV12, true, PixelFormat::Nv12},
                                         Case{V4L2_PIX_FMT_YUV420, true, PixelFormat::Yuv420p},
                                         Case{V4L2_PIX_FMT_BGR24, true, PixelFormat::Bgr24},
                                         Case{V4L2_PIX_FMT_NV12M, true, PixelFormat::Nv12},
                                         Case{V4L2_PIX_FMT_NV16M, true, PixelFormat::Nv16},
                                         Case{V4L2_PIX_FMT_YUV420M, true, PixelFormat::Yuv420p}),
                         [](const auto& test) {
                           return "Case" + std::to_string(test.index) +
                                  (test.param.multiplanar ? "Multi" : "Single");
                         });

struct Colour {
  __u32 fourcc, colorspace, ycbcr_enc, quantization;
  fake::Encoding encoding;
  YuvMatrix matrix;
  YuvRange range;
};

class V4l2Colour : public V4l2Test, public testing::WithParamInterface<Colour> {};

TEST_P(V4l2Colour, IsReadAsTheDriverSays) {
  const Colour c = GetParam();
  FakeV4l2Card::Options options;
  options.formats = {c.fourcc};
  options.colorspace = c.colorspace;
  options.ycbcr_enc = c.ycbcr_enc;
  options.quantization = c.quantization;
  options.encoding = c.encoding;
  plug(options);
  open();
  const Frame frame = nextPicture();
  ASSERT_FALSE(frame.empty());
  EXPECT_EQ(frame.format.matrix, c.matrix);
  EXPECT_EQ(frame.format.range, c.range);
  EXPECT_LE(farthest(frame, [](int x, int y) { return bars(x, y, 0, 0); }), 2.0);
}

constexpr fake::Encoding k601Limited{0.299, 0.114, true}, k601Full{0.299, 0.114, false};
constexpr fake::Encoding k709Limited{0.2126, 0.0722, true}, k709Full{0.2126, 0.0722, false};
constexpr fake::Encoding k2020Limited{0.2627, 0.0593, true};

INSTANTIATE_TEST_SUITE_P(
    All, V4l2Colour,
    testing::Values(
        Colour{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_REC709, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k709Limited, YuvMatrix::Bt709, YuvRange::Limited},
        Colour{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_SMPTE170M, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k601Limited, YuvMatrix::Bt601, YuvRange::Limited},
        Colour{V4L2_PIX_FMT_NV12, V4L2_COLORSPACE_SRGB, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k601Limited, YuvMatrix::Bt601, YuvRange::Limited},
        Colour{V4L2_PIX_FMT_NV12, V4L2_COLORSPACE_JPEG, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k601Full, YuvMatrix::Bt601, YuvRange::Full},
        Colour{V4L2_PIX_FMT_UYVY, V4L2_COLORSPACE_REC709, V4L2_YCBCR_ENC_601,
               V4L2_QUANTIZATION_FULL_RANGE, k601Full, YuvMatrix::Bt601, YuvRange::Full},
        Colour{V4L2_PIX_FMT_UYVY, V4L2_COLORSPACE_SMPTE170M, V4L2_YCBCR_ENC_709,
               V4L2_QUANTIZATION_FULL_RANGE, k709Full, YuvMatrix::Bt709, YuvRange::Full},
        Colour{V4L2_PIX_FMT_NV16, V4L2_COLORSPACE_BT2020, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k2020Limited, YuvMatrix::Bt2020, YuvRange::Limited},
        // An unknown colour space of a small picture is that of old television.
        Colour{V4L2_PIX_FMT_YUYV, V4L2_COLORSPACE_DEFAULT, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k601Limited, YuvMatrix::Bt601, YuvRange::Limited},
        Colour{V4L2_PIX_FMT_BGR24, V4L2_COLORSPACE_SRGB, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_DEFAULT, k601Full, YuvMatrix::Bt601, YuvRange::Full},
        Colour{V4L2_PIX_FMT_XBGR32, V4L2_COLORSPACE_REC709, V4L2_YCBCR_ENC_DEFAULT,
               V4L2_QUANTIZATION_LIM_RANGE, k709Limited, YuvMatrix::Bt601, YuvRange::Limited}));

TEST_F(V4l2Test, TheBestFormatInCommonIsChosenAndAnotherOnRequest) {
  plug({.formats = {V4L2_PIX_FMT_SBGGR8, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV}});
  open();
  EXPECT_EQ(nextPicture().format.pixel_format, PixelFormat::Yuyv);
  source.reset();
  open({.pixel_format = "NV12"});
  EXPECT_EQ(nextPicture().format.pixel_format, PixelFormat::Nv12);
}

TEST_F(V4l2Test, ACameraTooSlowUncompressedSendsJpegAndAFastOneDoesNot) {
  FakeV4l2Card::Options options{.digital = false,
                                .formats = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG},
                                .sizes = {{64, 48}, {128, 96}},
                                .compressed_fps = 60,
                                .raw_fps = 5};
  plug(options);
  open({.width = 128, .height = 96});
  EXPECT_EQ(card->fourcc(), V4L2_PIX_FMT_MJPEG);
  EXPECT_EQ(source->format().width, 128);
  options.raw_fps = 30;
  plug(options);
  open({.width = 128, .height = 96});
  EXPECT_EQ(card->fourcc(), V4L2_PIX_FMT_YUYV);
}

TEST_F(V4l2Test, WithoutAFormatInCommonItSaysWhatTheCardOffers) {
  plug({.formats = {V4L2_PIX_FMT_SBGGR8}});
  open();
  EXPECT_EQ(source->read(80ms).status, SourceStatus::UnsupportedMode);
  EXPECT_NE(source->detail().find("BA81"), std::string::npos) << source->detail();
}

}  // namespace
}  // namespace depthscope::capture
