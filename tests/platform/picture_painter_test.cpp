// The graphics processor's picture against the processor's, bit for bit.
#include "platform/display/gpu/picture_painter.hpp"

#include <gtest/gtest.h>

#include <random>

#include "capture/pixel_convert.hpp"
#include "overlay/blend.hpp"
#include "overlay/egl_context.hpp"

namespace depthscope::platform {
namespace {

using capture::FrameFormat;
using capture::PixelFormat;
using capture::YuvMatrix;
using capture::YuvRange;

constexpr PixelFormat formats[] = {PixelFormat::Gray8,   PixelFormat::Rgb24,   PixelFormat::Bgr24,
                                   PixelFormat::Rgba32,  PixelFormat::Bgrx32,  PixelFormat::Yuv420p,
                                   PixelFormat::Yuv422p, PixelFormat::Yuv444p, PixelFormat::Nv12,
                                   PixelFormat::Nv16,    PixelFormat::Yuyv,    PixelFormat::Uyvy};

class PicturePainterTest : public ::testing::Test {
 protected:
  static constexpr int screen_width = 96, screen_height = 64;

  PicturePainterTest() {
    glBindTexture(GL_TEXTURE_2D, texture.name());
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, screen_width, screen_height);
    glBindFramebuffer(GL_FRAMEBUFFER, target.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.name(), 0);
  }

  capture::Frame noise(const FrameFormat& format) {
    capture::Frame frame = capture::FramePool::create(format, 1)->acquire();
    for (int p = 0; p < capture::planeCount(format.pixel_format); ++p) {
      const capture::PlaneSize size = capture::planeSize(format, p);
      const capture::Plane& plane = frame.planes[static_cast<std::size_t>(p)];
      for (int y = 0; y < size.rows; ++y)
        for (int x = 0; x < size.row_bytes; ++x)
          plane.data[y * plane.stride + x] = static_cast<std::uint8_t>(random());
    }
    return frame;
  }
  /// Colour without alpha and more colour than alpha among it, as drivers round.
  std::vector<std::uint8_t> noisyLayer(int width, int height, const overlay::PixelRect& rect) {
    std::vector<std::uint8_t> layer(static_cast<std::size_t>(width * height * 4), 0);
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = 4 * rect.x0; x < 4 * rect.x1; ++x)
        if (random() % 5 != 0)
          layer[static_cast<std::size_t>(y * width * 4 + x)] = static_cast<std::uint8_t>(random());
    return layer;
  }
  std::vector<std::uint8_t> screen() {
    std::vector<std::uint8_t> pixels(screen_width * screen_height * 4);
    glReadPixels(0, 0, screen_width, screen_height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return pixels;
  }
  /// What the processor makes of the same, at the same place.
  static std::vector<std::uint8_t> byProcessor(const capture::Frame& frame, const LayerView& layer,
                                               int at_x, int at_y) {
    const int width = frame.format.width, height = frame.format.height;
    std::vector<std::uint8_t> picture(static_cast<std::size_t>(width * height * 4));
    capture::toRgba(frame, picture);
    std::vector<std::uint8_t> all(screen_width * screen_height * 4, 0);
    for (std::size_t i = 3; i < all.size(); i += 4) all[i] = 255;
    for (int y = 0; y < height; ++y) {
      std::uint8_t* row = &picture[static_cast<std::size_t>(y * width * 4)];
      if (y >= layer.rect.y0 && y < layer.rect.y1)
        overlay::blendRow(layer.pixels + y * width * 4, row, row, width);
      std::copy_n(row, width * 4,
                  &all[static_cast<std::size_t>(((at_y + y) * screen_width + at_x) * 4)]);
    }
    return all;
  }

  std::mt19937 random{7};
  overlay::EglContext context;
  overlay::GlTexture texture;
  overlay::GlFramebuffer target;
  PicturePainter painter;
};

TEST_F(PicturePainterTest, EveryFormatComesOutAsTheProcessorMakesIt) {
  for (const PixelFormat pixels : formats)
    for (const YuvMatrix matrix : {YuvMatrix::Bt601, YuvMatrix::Bt709, YuvMatrix::Bt2020})
      for (const YuvRange range : {YuvRange::Limited, YuvRange::Full})
        for (const auto& [width, height] : {std::pair{64, 48}, std::pair{37, 21}}) {
          const capture::Frame frame = noise({pixels, width, height, matrix, range});
          const overlay::PixelRect rect{3, 5, 31, 17};
          const auto pixels_of_layer = noisyLayer(width, height, rect);
          const LayerView layer{pixels_of_layer.data(), width, height, rect};
          ASSERT_TRUE(PicturePainter::takes(frame));
          ASSERT_TRUE(painter.paint(frame, layer, 9, 6, screen_width, screen_height));
          ASSERT_EQ(screen(), byProcessor(frame, layer, 9, 6))
              << "format " << static_cast<int>(pixels) << " matrix " << static_cast<int>(matrix)
              << " range " << static_cast<int>(range) << " width " << width;
        }
}

TEST_F(PicturePainterTest, EveryYuvTripleOfSixteenthsIsTheSame) {
  // 64 x 64 pixels of 4:4:4 hold 4096 triples: all that are made of 16 levels each.
  capture::Frame frame = noise({PixelFormat::Yuv444p, 64, 64});
  for (int p = 0; p < 3; ++p)
    for (int i = 0; i < 4096; ++i) {
      const capture::Plane& plane = frame.planes[static_cast<std::size_t>(p)];
      plane.data[i / 64 * plane.stride + i % 64] =
          static_cast<std::uint8_t>((i >> (4 * p) & 15) * 17);
    }
  ASSERT_TRUE(painter.paint(frame, {}, 0, 0, screen_width, screen_height));
  EXPECT_EQ(screen(), byProcessor(frame, {}, 0, 0));
}

TEST_F(PicturePainterTest, NothingIsLeftOfTheLayerBefore) {
  const capture::Frame frame = noise({PixelFormat::Yuyv, 64, 48});
  const auto full = noisyLayer(64, 48, {0, 0, 64, 48});
  ASSERT_TRUE(painter.paint(frame, {full.data(), 64, 48, {0, 0, 64, 48}}, 0, 0, screen_width,
                            screen_height));
  const LayerView small{full.data(), 64, 48, {8, 8, 8, 8}};
  ASSERT_TRUE(painter.paint(frame, small, 0, 0, screen_width, screen_height));
  EXPECT_EQ(screen(), byProcessor(frame, small, 0, 0));
}

TEST_F(PicturePainterTest, RowsThatDoNotHoldWholeTexelsAreNotTaken) {
  capture::Frame frame = noise({PixelFormat::Yuyv, 64, 48});
  frame.planes[0].stride += 1;
  EXPECT_FALSE(PicturePainter::takes(frame));
}

}  // namespace
}  // namespace depthscope::platform
