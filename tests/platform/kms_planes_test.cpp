// Captured pictures on a plane of their own, the overlay on another.
#include <gtest/gtest.h>

#include <cstring>

#include "kms_fixture.hpp"

namespace depthscope::platform {
namespace {

using fake::FakeKmsCard;
using fake::makeMode;
using std::chrono::milliseconds;

class KmsPlanesTest : public KmsDisplayTest {
 protected:
  KmsPlanesTest() {
    plugPlanes({{1, {DRM_FORMAT_XRGB8888}}, {0, {DRM_FORMAT_ARGB8888}}});
    layer.assign(width * height * 4, 0);
  }
  void plugPlanes(std::vector<FakeKmsCard::PlaneKind> planes) {
    display.reset();
    card.reset();
    card = std::make_unique<FakeKmsCard>(
        kernel, "card0",
        std::vector<FakeKmsCard::Connector>{
            {DRM_MODE_CONNECTOR_HDMIA,
             1,
             true,
             {makeMode(128, 96, 60, true), makeMode(width, height, 60)}}},
        std::move(planes));
  }
  /// A turn with a captured picture of one colour and a layer with one pixel in it, half
  /// transparent, at (spot, 1). True when the planes took it.
  bool planesTurn(std::uint32_t rgb, int spot,
                  capture::PixelFormat pixels = capture::PixelFormat::Bgrx32) {
    bool taken = false;
    if (!display->acquire(width, height).empty()) {
      capture::Frame frame = pool->acquire();
      EXPECT_FALSE(frame.empty()) << "a frame was not given back";
      auto buffer = std::make_unique<fake::FakeDmabuf>(width * height * 4);
      for (std::size_t i = 0; i < buffer->size; i += 4) std::memcpy(&buffer->memory[i], &rgb, 4);
      const kernel::OwnedFd fd(kernel, kernel.install(std::move(buffer)));
      const std::size_t at = static_cast<std::size_t>(width + spot) * 4;
      std::fill(layer.begin(), layer.end(), std::uint8_t{0});
      layer[at] = 0x40;  // red, premultiplied
      layer[at + 3] = 0x80;
      frame.format.pixel_format = pixels;
      frame.format.matrix = capture::YuvMatrix::Bt709;
      frame.format.range = pixels == capture::PixelFormat::Yuyv ? capture::YuvRange::Limited
                                                                : capture::YuvRange::Full;
      frame.planes[0].stride = width * 4;
      frame.dma[0] = {fd.get(), 0};
      const LayerView view{layer.data(), width, height, {spot, 1, spot + 1, 2}};
      const capture::Frame* held = display->presentFrame(frame, view, ++index);
      taken = held != nullptr;
      EXPECT_TRUE(!taken || !held->empty());
      if (!taken && frame.empty()) return false;  // the display failed
      EXPECT_EQ(frame.empty(), taken);
      if (!taken) offer(rgb);
    }
    kernel.advance(frame_time);
    return taken;
  }

  std::shared_ptr<capture::FramePool> pool =
      capture::FramePool::create({capture::PixelFormat::Rgba32, width, height}, 4);
  std::vector<std::uint8_t> layer;
};

TEST_F(KmsPlanesTest, ThePictureIsScannedOutFromWhereItWasCapturedWithTheLayerAboveIt) {
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  for (int i = 0; i < 12; ++i) {
    const auto rgb = static_cast<std::uint32_t>(0x204060 + i);
    EXPECT_TRUE(planesTurn(rgb, i));
    EXPECT_EQ(card->pixel(20, 20), rgb);
    EXPECT_EQ(card->pixel(i, 1) >> 16, 0x40u + 0x20 * 127 / 255);
    if (i > 0) {  // nothing is left of earlier layers
      EXPECT_EQ(card->pixel(i - 1, 1), rgb);
    }
  }
  EXPECT_EQ(card->modesets(), 1u);
  display.reset();
  expectClean();
  std::vector<capture::Frame> all;
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(all.emplace_back(pool->acquire()).empty());
}

TEST_F(KmsPlanesTest, ComposedPicturesTakeTheScreenBackWithoutAModeset) {
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  for (int i = 0; i < 3; ++i) planesTurn(2, 5);
  for (int i = 0; i < 2; ++i) turn(3);
  EXPECT_EQ(card->pixel(5, 1), 3u);
  EXPECT_EQ(card->planeValue(1, "FB_ID"), 0u);
  EXPECT_TRUE(planesTurn(4, 5));
  EXPECT_EQ(card->pixel(0, 0), 4u);
  EXPECT_EQ(card->modesets(), 1u);
  EXPECT_EQ(card->timesSwitchedOff(), 0u);
}

TEST_F(KmsPlanesTest, ADriverThatSaysNoIsAskedOnce) {
  card->planes_work = false;
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  EXPECT_FALSE(planesTurn(2, 1));
  const auto calls = kernel.calls();
  EXPECT_FALSE(planesTurn(3, 1));
  EXPECT_LE(kernel.calls() - calls, 10u);
  EXPECT_EQ(card->pixel(0, 0), 3u);
  EXPECT_EQ(card->timesSwitchedOff(), 0u);
}

TEST_F(KmsPlanesTest, PlanesThatLieTheWrongWayRoundAreNotTaken) {
  plugPlanes({{1, {DRM_FORMAT_XRGB8888}, 3}, {0, {DRM_FORMAT_ARGB8888}, 1}});
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  EXPECT_FALSE(planesTurn(2, 1));
  // An overlay below the primary plane can hold the picture, and the primary plane the layer.
  plugPlanes({{1, {DRM_FORMAT_XRGB8888, DRM_FORMAT_ARGB8888}, 3}, {0, {DRM_FORMAT_XRGB8888}, 1}});
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  EXPECT_TRUE(planesTurn(0x202020, 1));
  EXPECT_EQ(card->pixel(9, 9), 0x202020u);
}

TEST_F(KmsPlanesTest, YuvGoesOnlyToPlanesThatCanBeToldItsColours) {
  plugPlanes({{1, {DRM_FORMAT_XRGB8888, DRM_FORMAT_YUYV}}, {0, {DRM_FORMAT_ARGB8888}}});
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  EXPECT_FALSE(planesTurn(2, 1, capture::PixelFormat::Yuyv));
  plugPlanes({{1, {DRM_FORMAT_XRGB8888, DRM_FORMAT_YUYV}, -1, true}, {0, {DRM_FORMAT_ARGB8888}}});
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1);
  EXPECT_TRUE(planesTurn(2, 1, capture::PixelFormat::Yuyv));
  EXPECT_EQ(card->planeValue(0, "COLOR_ENCODING"), 5u);
  EXPECT_EQ(card->planeValue(0, "COLOR_RANGE"), 7u);
}

TEST_F(KmsPlanesTest, APictureLargerThanTheModeIsComposed) {
  settings.mode = "64x48";
  makeDisplay();
  for (int i = 0; i < 3; ++i) turn(1, 128, 96);
  capture::Frame frame =
      capture::FramePool::create(
          {capture::PixelFormat::Bgrx32, 128, 96, {}, capture::YuvRange::Full}, 1)
          ->acquire();
  frame.dma[0] = {7, 0};
  ASSERT_FALSE(display->acquire(128, 96).empty());
  EXPECT_EQ(display->presentFrame(frame, {layer.data(), 128, 96, {}}, 5), nullptr);
  EXPECT_FALSE(frame.empty());
}

TEST_F(KmsPlanesTest, SurvivesAFaultOfAnyCall) {
  const auto session = [&] {
    for (int i = 0; i < 3; ++i) turn(1);
    for (int i = 0; i < 5; ++i) planesTurn(2, i);
    turn(3);
    planesTurn(4, 1);
  };
  expectFaultsSurvived([&] { makeDisplay(); }, session,
                       [&](std::uint32_t color) { planesTurn(color, 1); }, [] {});
}

}  // namespace
}  // namespace depthscope::platform
