#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "capture/pixel_convert.hpp"
#include "overlay/blend.hpp"
#include "platform/daemon/video_loop.hpp"
#include "platform/ipc/surface_mailbox.hpp"
#include "tests/fake_kernel/fake_kernel.hpp"
#include "tests/platform/direct_layers.hpp"
#include "tests/types/grid_mesh.hpp"

namespace depthscope::platform {

using std::chrono::milliseconds;
using Time = kernel::SystemCalls::Time;

inline CameraModel smallCamera() {
  CameraModel c;
  c.width = 160;
  c.height = 120;
  c.fx = c.fy = 130;
  c.cx = 79.5;
  c.cy = 59.5;
  c.fps = 30;
  return c;
}

/// Hands out what the test put in, each entry at its time; nothing else to come: Timeout.
class ScriptedSource final : public capture::FrameSource {
 public:
  explicit ScriptedSource(fake::FakeKernel& system) : system_(system) {
    const CameraModel c = smallCamera();
    format_.width = c.width;
    format_.height = c.height;
    pool_ = capture::FramePool::create(format_, 4);
  }

  /// A picture at `at`, whose luma is a pattern of `sequence`, or a status.
  void add(Time at, capture::SourceStatus status = capture::SourceStatus::Ok,
           bool damaged = false) {
    script_.push_back({at, status, damaged, sequence_++});
  }
  void resize(int width, int height) {
    format_.width = width;
    format_.height = height;
    pool_ = capture::FramePool::create(format_, 4);
  }

  capture::ReadResult read(std::chrono::nanoseconds timeout) override {
    const Time limit = system_.now() + timeout;
    if (script_.empty() || script_.front().at > limit) {
      system_.advance(timeout);
      return {};
    }
    const Entry entry = script_.front();
    script_.pop_front();
    if (entry.at > system_.now()) system_.advance(entry.at - system_.now());
    if (entry.status != capture::SourceStatus::Ok) return {entry.status, {}, false};
    return {capture::SourceStatus::Ok, picture(entry), false};
  }
  std::function<void(capture::Frame&)> paint;  // something of the test's own into each picture
  capture::FrameFormat format() const override { return format_; }
  double fps() const override { return 30; }
  std::uint64_t skipped() const override { return 0; }

 private:
  struct Entry {
    Time at;
    capture::SourceStatus status;
    bool damaged;
    std::uint64_t sequence;
  };
  capture::Frame picture(const Entry& entry) {
    capture::Frame frame = pool_->acquire();
    for (int p = 0; p < 3; ++p) {
      const capture::PlaneSize size = capture::planeSize(format_, p);
      for (int y = 0; y < size.rows; ++y)
        for (int x = 0; x < size.row_bytes; ++x)
          frame.planes[static_cast<std::size_t>(p)]
              .data[y * frame.planes[static_cast<std::size_t>(p)].stride + x] =
              static_cast<std::uint8_t>(
                  30 + (x * 7 + y * 13 + p * 50 + static_cast<int>(entry.sequence) * 3) % 190);
    }
    frame.sequence = entry.sequence;
    frame.capture_time = entry.at;
    frame.damaged = entry.damaged;
    if (paint) paint(frame);
    return frame;
  }

  fake::FakeKernel& system_;
  capture::FrameFormat format_;
  std::shared_ptr<capture::FramePool> pool_;
  std::deque<Entry> script_;
  std::uint64_t sequence_ = 0;
};

/// Remembers what was shown, and when.
class RecordingDisplay final : public Display {
 public:
  struct Shown {
    Time at;
    std::int64_t index = 0;
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
  };
  explicit RecordingDisplay(fake::FakeKernel& system) : system_(system) {}
  std::span<std::uint8_t> acquire(int width, int height) override {
    buffer_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    width_ = width;
    height_ = height;
    if (busy) return {};
    return buffer_;
  }
  void present(std::int64_t index) override {
    system_.advance(milliseconds(2));
    if (keep) shown.push_back({system_.now(), index, width_, height_, buffer_});
  }
  bool takesFrame(const capture::Frame&) const override { return planes; }
  const capture::Frame* presentFrame(capture::Frame& frame, const LayerView& layer,
                                     std::int64_t index) override {
    if (refuse) return nullptr;
    held_ = std::move(frame);
    if (lose) return held_ = {}, nullptr;
    std::vector<std::uint8_t> screen(buffer_.size());
    capture::toRgba(held_, screen);
    for (int y = layer.rect.y0; y < layer.rect.y1; ++y) {
      const std::ptrdiff_t at = (static_cast<std::ptrdiff_t>(y) * layer.width + layer.rect.x0) * 4;
      overlay::blendRow(layer.pixels + at, screen.data() + at, screen.data() + at,
                        layer.rect.width());
    }
    shown.push_back({system_.now(), index, width_, height_, std::move(screen)});
    ++direct;
    return &held_;
  }
  DisplayState state() const override { return DisplayState::Ok; }
  std::optional<ShownPicture> takeShown() override {
    if (shown.size() <= told_) return std::nullopt;
    const Shown& next = shown[told_++];
    return ShownPicture{next.index, next.at, next.at + milliseconds(10)};
  }

  bool busy = false, keep = true;
  bool planes = false;                // lays overlays over captured pictures by itself
  bool refuse = false, lose = false;  // how it answers to a frame
  int direct = 0;                     // pictures shown so
  std::vector<Shown> shown;

 private:
  fake::FakeKernel& system_;
  std::size_t told_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> buffer_;
  capture::Frame held_;
};

/// A video loop on a simulated clock, with a real compositor; the test plays source and AR process.
class VideoLoopFixture : public testing::Test {
 protected:
  explicit VideoLoopFixture(const overlay::OverlaySettings& overlay = {})
      : painter(camera, overlay, link, requests) {}

  void SetUp() override { makeLoop(); }
  void makeLoop() {
    loop = std::make_unique<VideoLoop>(
        VideoLoop::Parts{source, display, layers, link, requests, report, nullptr, system},
        settings, "", camera.width, camera.height);
  }

  /// A surface 50 mm before the camera, over the middle of the picture.
  void sendSurface() {
    SurfaceMesh mesh = gridMesh(12, [](float u, float v) {
      return Eigen::Vector3f(-15 + 30 * u, -8 + 20 * v, 50 + 12 * u);
    });
    mesh.version = ++surface_version;
    SurfaceMailboxWriter writer(memory);
    ASSERT_TRUE(writer.publish(mesh));
  }
  void sendPose(std::int64_t frame, TrackingState state = TrackingState::Tracking) {
    PoseEstimate pose;
    pose.frame = frame;
    pose.state = state;
    pose.confidence = 1;
    memory.block().pose.write(encodePose(pose));
  }
  /// One picture through the loop, tracked at once if asked.
  void showPicture(bool tracked) {
    next += milliseconds(33);
    source.add(next);
    if (tracked) sendPose(sequence - 1);
    ++sequence;
    ASSERT_TRUE(loop->turn());
  }
  const RecordingDisplay::Shown& last() const { return display.shown.back(); }

  const CameraModel camera = smallCamera();
  fake::FakeKernel system;
  ScriptedSource source{system};
  RecordingDisplay display{system};
  SharedMemory memory = SharedMemory::create({160, 120, 1000, 2000});
  ArLink link{memory, 120};
  VideoRequests requests;
  VideoReport report;
  LayerPainter painter;
  DirectLayers layers{painter};
  VideoLoopSettings settings;
  std::unique_ptr<VideoLoop> loop;
  Time next = system.now();
  std::int64_t sequence = 0;
  std::uint32_t surface_version = 0;
};

}  // namespace depthscope::platform
