// The video delay as the pictures themselves tell it: the sample clip plays at its rate through
// video loop, overlay thread and the real AR process; each picture carries a binary clock with its
// capture time, which is read back from what goes to the display.
//
//   latency_clock [SECONDS [exact]]      20 s, lowest latency, when nothing is said
//
// Fails when the pictures tell another delay than the loop's own figures, or come twice or out of
// order. Whether the delay is a good one is for the reader to judge: the machine may be a busy one.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

#include "capture/file_source.hpp"
#include "platform/camera_file.hpp"
#include "platform/daemon/ar_supervisor.hpp"
#include "platform/daemon/overlay_thread.hpp"
#include "platform/daemon/video_thread.hpp"
#include "tests/e2e/program.hpp"
#include "tests/platform/binary_clock.hpp"

namespace depthscope::platform {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

const fs::path sample = fs::path(DEPTHSCOPE_TEST_DATA) / "sample";

/// The clip in a loop, a clock drawn into every picture.
class ClockedSource final : public capture::FrameSource {
 public:
  ClockedSource(const CameraModel& camera, const BinaryClock& clock) : clock_(clock) {
    capture::FileSourceSettings settings;
    settings.path = sample / "video.mp4";
    settings.pacing = capture::FileSourceSettings::Pacing::Clip;
    settings.loop = true;
    settings.fps = camera.fps;
    settings.buffers = 8;
    clip_ = capture::openFileSource(settings);
  }
  capture::ReadResult read(std::chrono::nanoseconds timeout) override {
    capture::ReadResult result = clip_->read(timeout);
    if (result.status == capture::SourceStatus::Ok)
      clock_.draw(result.frame, result.frame.capture_time);
    return result;
  }
  capture::FrameFormat format() const override { return clip_->format(); }
  double fps() const override { return clip_->fps(); }
  std::uint64_t skipped() const override { return clip_->skipped(); }

 private:
  const BinaryClock& clock_;
  std::unique_ptr<capture::FrameSource> clip_;
};

/// Reads the clock out of every picture that it is given.
class ClockReader final : public Display {
 public:
  explicit ClockReader(const BinaryClock& clock) : clock_(clock) {}
  std::span<std::uint8_t> acquire(int width, int height) override {
    buffer_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    return buffer_;
  }
  void present(std::int64_t) override {
    const auto now = Clock::now();
    const auto captured = clock_.read(buffer_);
    if (!captured) {
      ++unreadable;
      return;
    }
    if (*captured <= last_) ++not_new;
    last_ = *captured;
    delay_ms.add(std::chrono::duration<double, std::milli>(now - *captured).count());
  }
  DisplayState state() const override { return DisplayState::Ok; }

  Histogram delay_ms;
  int unreadable = 0, not_new = 0;

 private:
  const BinaryClock& clock_;
  Clock::time_point last_{};
  std::vector<std::uint8_t> buffer_;
};

void print(const char* who, const DurationSummary& s) {
  std::printf("%-12s %llu pictures, p50 %.2f ms, p99 %.2f ms, p99.9 %.2f ms, max %.2f ms\n", who,
              static_cast<unsigned long long>(s.count), s.p50, s.p99, s.p999, s.max);
}

int run(double seconds, bool exact) {
  const CameraModel camera = loadCameraFile(sample / "camera.yaml");
  const BinaryClock clock(camera.width, camera.height);
  Settings settings;
  settings.capture.camera = sample / "camera.yaml";
  settings.overlay.inset = false;  // it would cover the clock
  const SharedMemory memory =
      SharedMemory::create({static_cast<std::uint32_t>(camera.width),
                            static_cast<std::uint32_t>(camera.height), 120000, 240000});
  ClockedSource source(camera, clock);
  ClockReader display(clock);
  ArLink link(memory, settings.overlay.max_age_ms);
  const PoseWait wait(memory, kernel::realSystemCalls());
  ArSupervisor ar({programPath("depthscope-ar"), "--camera", settings.capture.camera}, memory,
                  settings);
  VideoRequests requests;
  VideoReport report;
  OverlayThread layers([&] {
    auto painter = std::make_unique<LayerPainter>(camera, settings.overlay, link, requests);
    painter->waitForPoses(exact ? &wait : nullptr);
    return painter;
  });
  VideoLoopSettings loop;
  if (exact) loop.overlay_wait = static_cast<float>(settings.display.exact_wait);
  VideoThread video(
      [&] {
        return std::make_unique<VideoLoop>(
            VideoLoop::Parts{source, display, layers, link, requests, report, nullptr,
                             kernel::realSystemCalls()},
            loop, "", camera.width, camera.height);
      },
      settings.daemon.realtime_priority, report);
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(seconds));
  while (Clock::now() < end) {
    ar.tick(Clock::now());
    link.setAlive(ar.alive());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  video.stop();

  FrameClockSummary times;
  report.times.read(times);
  const DurationSummary by_pictures = summarize(display.delay_ms);
  print("by pictures", by_pictures);
  print("by the loop", times.video_delay);
  std::printf(
      "overlay age p50 %.2f ms, p99 %.2f ms; tracked %llu, skipped by the source %llu, stale "
      "%llu\n",
      times.overlay_age.p50, times.overlay_age.p99,
      static_cast<unsigned long long>(report.tracked.load()),
      static_cast<unsigned long long>(report.skipped.load()),
      static_cast<unsigned long long>(report.stale.load()));
  std::printf("unreadable %d, not new %d\n", display.unreadable, display.not_new);
  // A picture shown again as stale is darkened and says nothing, or what it said before; nor can
  // a clock be read that the surface lies over for a while. The loop's summary is up to 30 pictures
  // old.
  const bool agree = std::abs(by_pictures.p50 - times.video_delay.p50) < 1;
  const bool good =
      agree && display.not_new <= static_cast<int>(report.stale.load()) && by_pictures.count > 30 &&
      display.unreadable <= static_cast<int>(report.faults.load() + by_pictures.count / 5);
  std::printf("%s\n", good ? "the pictures agree with the loop" : "the pictures DISAGREE");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace depthscope::platform

int main(int argc, char** argv) {
  try {
    return depthscope::platform::run(argc > 1 ? std::atof(argv[1]) : 20,
                                     argc > 2 && std::strcmp(argv[2], "exact") == 0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "latency_clock: %s\n", error.what());
    return 1;
  }
}
