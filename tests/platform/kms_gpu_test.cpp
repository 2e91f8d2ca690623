// Pictures that the graphics processor composes. Its driver cannot run on a card in memory, so one
// that draws with the processor stands for it; the driver's own drawing is in picture_painter_test.
#include <gtest/gtest.h>

#include <cstring>

#include "capture/pixel_convert.hpp"
#include "kms_fixture.hpp"
#include "overlay/blend.hpp"

namespace depthscope::platform {
namespace {

using kms::Card;
using kms::GpuComposer;
using std::chrono::milliseconds;

struct FakeDriver {
  int made = 0, make_error = 0, draw_error = 0;
  bool fences = true;
};
FakeDriver driver;

class FakeComposer final : public GpuComposer {
 public:
  explicit FakeComposer(Card& card) : card_(card) {}
  int create(int width, int height) {
    for (kms::DumbBuffer& buffer : buffers_)
      if (const int error =
              kms::DumbBuffer::create(card_, width, height, DRM_FORMAT_XRGB8888, buffer))
        return error;
    return 0;
  }
  bool takes(const capture::Frame& frame) const override { return frame.format.width <= 64; }
  int draw(int buffer, const capture::Frame& frame, const LayerView& layer,
           kernel::OwnedFd& done) override {
    if (driver.draw_error != 0) return driver.draw_error;
    kms::DumbBuffer& target = buffers_[static_cast<std::size_t>(buffer)];
    const int width = frame.format.width, height = frame.format.height;
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(width * height * 4));
    capture::toRgba(frame, rgba);
    for (int y = 0; y < height; ++y) {
      std::uint8_t* row = &rgba[static_cast<std::size_t>(y * width * 4)];
      overlay::blendRow(layer.pixels + y * width * 4, row, row, width);
      copyRow(row, width, PixelLayout::Bgrx32, target.bytes().data() + y * target.pitch());
    }
    auto& kernel = static_cast<fake::FakeKernel&>(card_.calls());
    if (driver.fences) done = {kernel, kernel.install(std::make_unique<fake::FakeDmabuf>(1))};
    return 0;
  }
  std::uint32_t framebuffer(int buffer) const override {
    return buffers_[static_cast<std::size_t>(buffer)].framebuffer();
  }

 private:
  Card& card_;
  std::array<kms::DumbBuffer, buffer_count> buffers_;
};

int makeFakeComposer(Card& card, int width, int height, std::unique_ptr<GpuComposer>& composer) {
  ++driver.made;
  if (driver.make_error != 0) return driver.make_error;
  auto made = std::make_unique<FakeComposer>(card);
  if (const int error = made->create(width, height)) return error;
  composer = std::move(made);
  return 0;
}

class KmsGpuTest : public KmsDisplayTest {
 protected:
  KmsGpuTest() {
    driver = {};
    settings.route = DisplayRoute::Gpu;
    layer.assign(width * height * 4, 0);
  }
  void make(kms::GpuComposerMaker maker = makeFakeComposer) {
    display = std::make_unique<kms::KmsDisplay>(settings, kernel, 30, maker);
    for (int i = 0; i < 3; ++i) turn(1);
  }
  /// A turn with a captured picture of one colour and a layer with one pixel in it, half
  /// transparent, at (spot, 1). True when it was not left to the processor.
  bool gpuTurn(std::uint32_t rgb, int spot) {
    bool taken = false;
    if (!display->acquire(width, height).empty()) {
      capture::Frame frame = pool->acquire();
      EXPECT_FALSE(frame.empty()) << "a frame was not given back";
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          std::memcpy(frame.planes[0].data + y * frame.planes[0].stride + 4 * x, &rgb, 4);
      const std::size_t at = static_cast<std::size_t>(width + spot) * 4;
      std::fill(layer.begin(), layer.end(), std::uint8_t{0});
      layer[at] = 0x40;  // red, premultiplied
      layer[at + 3] = 0x80;
      const capture::Frame* held = display->presentFrame(
          frame, {layer.data(), width, height, {spot, 1, spot + 1, 2}}, ++index);
      taken = held != nullptr;
      EXPECT_TRUE(!taken || !held->empty());
      if (!taken && frame.empty()) return false;  // the display failed
      EXPECT_EQ(frame.empty(), taken);
      if (!taken) offer(rgb);
    }
    kernel.advance(frame_time);
    return taken;
  }

  std::shared_ptr<capture::FramePool> pool = capture::FramePool::create(
      {capture::PixelFormat::Bgrx32, width, height, {}, capture::YuvRange::Full}, 4);
  std::vector<std::uint8_t> layer;
};

TEST_F(KmsGpuTest, PictureAndLayerAreComposedWithoutTheProcessorAndShownAtTheVblank) {
  make();
  for (int i = 0; i < 12; ++i) {
    const auto rgb = static_cast<std::uint32_t>(0x204060 + i);
    EXPECT_TRUE(gpuTurn(rgb, i));
    EXPECT_EQ(card->pixel(20, 20), rgb);
    EXPECT_EQ(card->pixel(i, 1) >> 16, 0x40u + 0x10u);  // half of 0x20 below it
    EXPECT_NE(card->planeValue(0, "IN_FENCE_FD"), fake::FakeKmsCard::no_fence);
  }
  EXPECT_EQ(driver.made, 1);
  EXPECT_EQ(card->modesets(), 1u);
  EXPECT_EQ(card->timesSwitchedOff(), 0u);
  int shown = 0;
  while (display->takeShown()) ++shown;
  EXPECT_GT(shown, 0);
  display.reset();
  expectClean();
}

TEST_F(KmsGpuTest, ADriverWithoutFencesHasFinishedAlready) {
  driver.fences = false;
  make();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(gpuTurn(5, i));
  EXPECT_EQ(card->pixel(20, 20), 5u);
  EXPECT_EQ(card->planeValue(0, "IN_FENCE_FD"), fake::FakeKmsCard::no_fence);
}

TEST_F(KmsGpuTest, ComposedPicturesTakeTheScreenBackWithoutAModeset) {
  make();
  for (int i = 0; i < 3; ++i) gpuTurn(2, 5);
  for (int i = 0; i < 2; ++i) turn(3);
  EXPECT_EQ(card->pixel(5, 1), 3u);
  EXPECT_TRUE(gpuTurn(4, 5));
  EXPECT_EQ(card->pixel(0, 0), 4u);
  EXPECT_EQ(card->modesets(), 1u);
}

TEST_F(KmsGpuTest, WithoutADriverTheProcessorComposesAndItIsNotAskedAgain) {
  driver.make_error = -ENOTSUP;
  make();
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(gpuTurn(7, i));
  EXPECT_EQ(card->pixel(0, 0), 7u);
  EXPECT_EQ(driver.made, 1);
  // A monitor that is plugged in again may be another one, and another way to it.
  driver.make_error = 0;
  card->setConnected(0, false);
  for (int i = 0; i < 10; ++i) gpuTurn(8, 1);
  card->setConnected(0, true);
  for (int i = 0; i < 30; ++i) gpuTurn(9, 1);
  EXPECT_EQ(driver.made, 2);
  EXPECT_TRUE(gpuTurn(10, 1));
}

TEST_F(KmsGpuTest, ADriverThatFailsIsLeftAlone) {
  make();
  EXPECT_TRUE(gpuTurn(2, 1));
  driver.draw_error = -EIO;
  EXPECT_FALSE(gpuTurn(3, 1));
  EXPECT_EQ(card->pixel(0, 0), 3u);
  driver.draw_error = 0;
  EXPECT_FALSE(gpuTurn(4, 1));
  EXPECT_EQ(card->pixel(0, 0), 4u);
  EXPECT_EQ(display->state(), DisplayState::Ok);
}

TEST_F(KmsGpuTest, OnlyWhoAsksForItGetsIt) {
  for (const DisplayRoute route : {DisplayRoute::Auto, DisplayRoute::Cpu}) {
    settings.route = route;
    make();
    EXPECT_FALSE(gpuTurn(2, 1));
    EXPECT_EQ(driver.made, 0);
    display.reset();
  }
}

TEST_F(KmsGpuTest, TheRealOneSaysThatThisCardHasNoDriver) {
  make(kms::makeGbmComposer);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(gpuTurn(7, i));
  EXPECT_EQ(card->pixel(0, 0), 7u);
}

TEST_F(KmsGpuTest, SurvivesAFaultOfAnyCall) {
  const auto session = [&] {
    for (int i = 0; i < 5; ++i) gpuTurn(2, i);
    turn(3);
    gpuTurn(4, 1);
  };
  expectFaultsSurvived([&] { make(); }, session, [&](std::uint32_t color) { gpuTurn(color, 1); },
                       [] {});
}

}  // namespace
}  // namespace depthscope::platform
