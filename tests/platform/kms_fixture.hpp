#pragma once
#include <gtest/gtest.h>

#include <cstdio>

#include "platform/display/kms/kms_display.hpp"
#include "tests/fake_kernel/fake_kms_card.hpp"

namespace depthscope::platform {

/// A KMS display on a fake card with one HDMI monitor, and a video loop's turn.
class KmsDisplayTest : public ::testing::Test {
 protected:
  static constexpr int width = 64, height = 48;
  static constexpr std::chrono::nanoseconds frame_time{33'333'333};

  KmsDisplayTest() { plugCard({DRM_FORMAT_XRGB8888}); }

  void plugCard(std::vector<std::uint32_t> formats) {
    card.reset();
    card = std::make_unique<fake::FakeKmsCard>(
        kernel, "card0",
        std::vector<fake::FakeKmsCard::Connector>{
            {DRM_MODE_CONNECTOR_HDMIA,
             1,
             true,
             {fake::makeMode(128, 96, 60, true), fake::makeMode(width, height, 60),
              fake::makeMode(width, height, 50)}}},
        std::vector<fake::FakeKmsCard::PlaneKind>{{1, std::move(formats)}});
  }
  void makeDisplay(double fps = 30) {
    display = std::make_unique<kms::KmsDisplay>(settings, kernel, fps);
  }
  /// One turn of the video loop: a picture of one colour (0xRRGGBB) offered; then its time passes.
  /// True when the display took it.
  bool turn(std::uint32_t rgb, int w = width, int h = height) {
    const bool taken = offer(rgb, w, h);
    kernel.advance(frame_time);
    return taken;
  }
  bool offer(std::uint32_t rgb, int w = width, int h = height) {
    const auto out = display->acquire(w, h);
    if (out.empty()) return false;
    EXPECT_EQ(out.size(), static_cast<std::size_t>(w * h * 4));
    for (std::size_t i = 0; i < out.size(); i += 4) {
      out[i] = static_cast<std::uint8_t>(rgb >> 16);
      out[i + 1] = static_cast<std::uint8_t>(rgb >> 8);
      out[i + 2] = static_cast<std::uint8_t>(rgb);
      out[i + 3] = 255;
    }
    display->present(++index);
    return true;
  }
  /// Nothing of ours is left in the kernel.
  void expectClean() {
    EXPECT_EQ(kernel.openDescriptors(), 0u);
    EXPECT_EQ(kernel.mappings(), 0u);
    EXPECT_EQ(kernel.misuses(), 0u);
    EXPECT_EQ(card->buffers(), 0u);
    EXPECT_EQ(card->framebuffers(), 0u);
    EXPECT_EQ(card->blobs(), 0u);
    EXPECT_TRUE(card->consoleShown());
  }

  /// Every call of `session` in turn goes wrong, once or until further notice: the display never
  /// throws, hangs or leaks, and the picture is back within 500 ms of the fault's end. `make` makes
  /// the display, `show` is a turn with a picture of one colour, `look` looks at it afterwards.
  template <class Make, class Session, class Show, class Look>
  void expectFaultsSurvived(Make make, Session session, Show show, Look look) {
    using std::chrono::milliseconds;
    make();
    const auto start = kernel.calls();
    session();
    const auto calls = kernel.calls() - start;
    display.reset();
    expectClean();
    int injected = 0;
    for (const int error : {EIO, ENODEV, EAGAIN, EINTR, EINVAL, EBUSY, EACCES})
      for (const bool forever : {false, true})
        for (std::uint64_t k = 1; k <= calls; ++k) {
          SCOPED_TRACE(testing::Message() << "call " << k << " errno " << error << " " << forever);
          make();
          kernel.inject({.call = kernel.calls() + k, .forever = forever, .error = error});
          session();
          ++injected;
          kernel.inject({});
          const auto lifted = kernel.now();
          const std::uint32_t color = 0x700000 + static_cast<std::uint32_t>(k);
          while (card->pixel(40, 30) != color && kernel.now() < lifted + milliseconds(600))
            show(color);
          ASSERT_EQ(card->pixel(40, 30), color);
          ASSERT_LE(kernel.now() - lifted, milliseconds(500));
          look();
          display.reset();
          expectClean();
          if (HasFailure()) return;
        }
    std::printf("faults injected and survived: %d\n", injected);
  }

  fake::FakeKernel kernel;
  std::unique_ptr<fake::FakeKmsCard> card;
  DisplaySettings settings;
  std::unique_ptr<kms::KmsDisplay> display;
  std::int64_t index = 0;
};

}  // namespace depthscope::platform
