#include <cstdio>

#include <jpeglib.h>

#include <random>

#include "capture/jpeg_decoder.hpp"
#include "tests/capture/v4l2_test_card.hpp"

namespace depthscope::capture {
namespace {

struct Sampling {
  int across, down;
  PixelFormat format;
};
constexpr Sampling k422{2, 1, PixelFormat::Yuv422p};

/// A JPEG of the scene, as a camera would send it. `across`, `down`: pixels to a chroma sample.
std::vector<std::uint8_t> encode(int width, int height, const Sampling& sampling,
                                 const std::function<Rgb(int, int)>& scene,
                                 bool progressive = false) {
  jpeg_compress_struct encoder{};
  jpeg_error_mgr errors{};
  encoder.err = jpeg_std_error(&errors);
  jpeg_create_compress(&encoder);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&encoder, &bytes, &size);
  encoder.image_width = static_cast<JDIMENSION>(width);
  encoder.image_height = static_cast<JDIMENSION>(height);
  const bool gray = sampling.format == PixelFormat::Gray8;
  encoder.input_components = gray ? 1 : 3;
  encoder.in_color_space = gray ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&encoder);
  jpeg_set_quality(&encoder, 98, TRUE);
  encoder.comp_info[0].h_samp_factor = sampling.across;
  encoder.comp_info[0].v_samp_factor = sampling.down;
  if (progressive) jpeg_simple_progression(&encoder);
  jpeg_start_compress(&encoder, TRUE);
  std::vector<std::uint8_t> row(static_cast<std::size_t>(3 * width));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Rgb c = scene(x, y);
      const double channels[] = {c.r, c.g, c.b};
      for (int i = 0; i < (gray ? 1 : 3); ++i)
        row[static_cast<std::size_t>((gray ? 1 : 3) * x + i)] =
            static_cast<std::uint8_t>(255 * channels[i] + 0.5);
    }
    JSAMPROW rows[] = {row.data()};
    jpeg_write_scanlines(&encoder, rows, 1);
  }
  jpeg_finish_compress(&encoder);
  jpeg_destroy_compress(&encoder);
  std::vector<std::uint8_t> out(bytes, bytes + size);
  std::free(bytes);
  return out;
}

class V4l2Mjpg : public V4l2Test {
 protected:
  void plugCamera(__u32 width, __u32 height) {
    plug({.digital = false, .formats = {V4L2_PIX_FMT_MJPEG}, .sizes = {{width, height}}});
  }
};

class V4l2MjpgSampling : public V4l2Mjpg, public testing::WithParamInterface<Sampling> {};

/// 70 x 50 is no multiple of a JPEG's blocks; colours change slowly, as chroma is shared.
TEST_P(V4l2MjpgSampling, EveryPixelIsWhatTheCameraSaw) {
  const bool gray = GetParam().format == PixelFormat::Gray8;
  const auto scene = [&](int x, int y) {
    return gray ? Rgb{x / 80.0, x / 80.0, x / 80.0} : Rgb{x / 80.0, y / 60.0, 0.5};
  };
  plugCamera(70, 50);
  card->setJpeg([&](std::uint64_t) { return encode(70, 50, GetParam(), scene); });
  open();
  for (int i = 0; i < 3; ++i) {
    const Frame frame = nextPicture();
    ASSERT_FALSE(frame.empty()) << source->detail();
    EXPECT_EQ(frame.format.pixel_format, GetParam().format);
    EXPECT_EQ(frame.format.range, YuvRange::Full);
    EXPECT_LE(farthest(frame, scene), 8.0);
  }
  EXPECT_EQ(source->damagedFrames(), 0u);
}

INSTANTIATE_TEST_SUITE_P(All, V4l2MjpgSampling,
                         testing::Values(Sampling{2, 2, PixelFormat::Yuv420p}, k422,
                                         Sampling{1, 1, PixelFormat::Yuv444p},
                                         Sampling{1, 1, PixelFormat::Gray8}));

TEST_F(V4l2Mjpg, APictureBrokenOffIsDamagedAndTheNextOneIsShown) {
  plugCamera(64, 48);
  const auto good = encode(64, 48, k422, [](int x, int y) { return bars(x, y, 0, 0); });
  card->setJpeg([&](std::uint64_t index) {
    auto bytes = good;
    if (index == 1) bytes.resize(bytes.size() / 2);
    if (index == 2) bytes.assign(bytes.size(), 0);
    return bytes;
  });
  open();
  EXPECT_EQ(nextPicture().sequence, 0u);
  EXPECT_EQ(nextPicture().sequence, 3u);
  EXPECT_EQ(source->damagedFrames(), 2u);
}

TEST_F(V4l2Mjpg, PicturesThatAreNeverWholeAreAFaultAndNotACrash) {
  plugCamera(64, 48);
  card->setJpeg([&](std::uint64_t) { return std::vector<std::uint8_t>{0xff, 0xd8, 0xff}; });
  open();
  EXPECT_EQ(source->read(80ms).status, SourceStatus::Timeout);
  EXPECT_EQ(source->read(300ms).status, SourceStatus::DamagedFrames);
}

TEST_F(V4l2Mjpg, APictureOfAnotherSizeIsDamaged) {
  plugCamera(64, 48);
  const auto other = encode(32, 32, k422, [](int x, int y) { return bars(x, y, 0, 0); });
  card->setJpeg([&](std::uint64_t) { return other; });
  open();
  EXPECT_TRUE(nextPicture(400ms).empty());
  EXPECT_GT(source->damagedFrames(), 5u);
}

TEST(JpegDecoder, ProgressiveOnesAreRefused) {
  const auto scene = [](int x, int y) { return bars(x, y, 0, 0); };
  JpegDecoder decoder;
  FrameFormat format;
  EXPECT_TRUE(decoder.readHeader(encode(64, 48, k422, scene), format));
  EXPECT_FALSE(decoder.readHeader(encode(64, 48, k422, scene, true), format));
}

/// Whatever comes over the wire: no crash, nothing written outside the picture.
TEST(JpegDecoder, SurvivesFlippedBytes) {
  const auto good = encode(64, 48, k422, [](int x, int y) {
    return Rgb{x / 64.0, y / 48.0, (x ^ y) % 8 / 8.0};
  });
  JpegDecoder decoder;
  std::mt19937 random(5);
  int decoded = 0;
  for (int i = 0; i < 3000; ++i) {
    auto bytes = good;
    for (int flips = 0; flips < 1 + i % 4; ++flips)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    FrameFormat format;
    if (!decoder.readHeader(bytes, format)) continue;
    if (format.width > 512 || format.height > 512) continue;
    Frame frame = FramePool::create(format, 1)->acquire();
    decoded += decoder.decode(frame);
  }
  EXPECT_GT(decoded, 0);
}

}  // namespace
}  // namespace depthscope::capture
