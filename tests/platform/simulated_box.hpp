#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "capture/v4l2_source.hpp"
#include "platform/daemon/video_loop.hpp"
#include "platform/display/kms/kms_display.hpp"
#include "tests/fake_kernel/fake_kms_card.hpp"
#include "tests/fake_kernel/fake_v4l2_card.hpp"

namespace depthscope::platform {

using fake::FakeKernel;
using fake::FakeKmsCard;
using fake::FakeV4l2Card;
using fake::FaultPlan;
using std::chrono::milliseconds;
using Time = FakeKernel::Time;

inline constexpr int box_width = 64, box_height = 48;  // [px]
inline constexpr double box_rate = 60;                 // [1/s] of card and monitor
/// The picture's colour tells its number: levels that survive limited-range YUV.
inline fake::Rgb sceneAt(std::uint64_t index) {
  const double level = static_cast<double>(index % 64) / 64;
  return {0.25 + 0.7 * level, 0.25 + 0.7 * level, 0.25 + 0.7 * level};
}

/// No overlay: what is drawn over the picture is not this test's matter.
class NoLayers final : public LayerSource {
 public:
  void request(const LayerRequest&) override {}
  const OverlayLayer* newest(Time) override { return nullptr; }
};

/// The whole video path, from capture card to monitor, on a kernel in memory and its clock.
class SimulatedBox {
 public:
  SimulatedBox()
      : card(kernel, cardOptions()),
        monitor(kernel, "card0",
                {{DRM_MODE_CONNECTOR_HDMIA,
                  1,
                  true,
                  {fake::makeMode(box_width, box_height, box_rate), fake::makeMode(80, 60, 50)}}}) {
    kernel.plug("/dev/video0", card);
    card.setMode(fake::timingsSmall(box_width, box_height, box_rate));
    card.setScene([](int, int, std::uint64_t index, int) { return sceneAt(index); });
  }

  /// `overlay`: null for none, which is what most that is looked at here needs.
  void start(LayerSource* overlay = nullptr) {
    capture::V4l2Settings capture;
    capture.device = "/dev/video0";
    source_ = std::make_unique<capture::V4l2Source>(capture, kernel);
    display_ = std::make_unique<kms::KmsDisplay>(DisplaySettings{}, kernel, box_rate);
    loop_ = std::make_unique<VideoLoop>(
        VideoLoop::Parts{*source_, *display_, overlay != nullptr ? *overlay : none_, link, requests,
                         report, nullptr, kernel},
        VideoLoopSettings{}, "", box_width, box_height);
    watchScreen();
  }
  void stop() {
    loop_.reset();
    display_.reset();
    source_.reset();
  }

  /// One turn of the loop; what must hold after each is checked.
  void turn() {
    const Time before = kernel.now();
    ASSERT_NO_THROW(ASSERT_TRUE(loop_->turn()));
    const auto took = kernel.now() - before;
    longest_turn = std::max(longest_turn, took);
    // A loop that spins would stand still on a clock that only calls move.
    if (took < std::chrono::microseconds(100)) kernel.advance(std::chrono::microseconds(100));
    watchScreen();
  }
  void runUntil(Time end) {
    while (kernel.now() < end && !testing::Test::HasFatalFailure()) turn();
  }
  /// Until pictures flow again; how long it took.
  std::chrono::nanoseconds recover() {
    const Time start = kernel.now();
    const std::uint64_t shown = screen_changes_, frames = report.frames.load();
    while ((screen_changes_ < shown + 3 || report.frames.load() < frames + 3) &&
           kernel.now() - start < milliseconds(2000) && !testing::Test::HasFatalFailure())
      turn();
    return kernel.now() - start;
  }
  bool displayWorks() const { return display_->state() == DisplayState::Ok; }

  FakeKernel kernel;
  FakeV4l2Card card;
  FakeKmsCard monitor;
  SharedMemory memory = SharedMemory::create({box_width, box_height, 1000, 2000});
  ArLink link{memory, 120};
  VideoRequests requests;
  VideoReport report;
  std::chrono::nanoseconds longest_turn{0};
  std::chrono::nanoseconds longest_unmarked{
      0};  // an unchanged live picture on a monitor that works

 private:
  static FakeV4l2Card::Options cardOptions() {
    FakeV4l2Card::Options options;
    options.formats = {V4L2_PIX_FMT_YUYV};
    return options;
  }

  /// A place in the corner where notices are not drawn, but fault pictures and stale ones are dark.
  void watchScreen() {
    const std::uint32_t pixel = monitor.pixel(box_width - 2, box_height - 2);
    if (pixel != screen_) {
      screen_ = pixel;
      screen_since_ = kernel.now();
      const bool live =
          (pixel & 0xff) >= 0x38;  // sceneAt() never goes below, halved it never reaches
      live_ = live;
      if (live) ++screen_changes_;
    }
    if (live_ && display_ && displayWorks())
      longest_unmarked = std::max(longest_unmarked, kernel.now() - screen_since_);
  }

  NoLayers none_;
  std::unique_ptr<capture::V4l2Source> source_;
  std::unique_ptr<kms::KmsDisplay> display_;
  std::unique_ptr<VideoLoop> loop_;
  std::uint32_t screen_ = 0;
  bool live_ = false;
  Time screen_since_{};
  std::uint64_t screen_changes_ = 0;
};

}  // namespace depthscope::platform
