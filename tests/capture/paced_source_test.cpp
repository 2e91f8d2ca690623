#include "capture/paced_source.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/capture/clip_writer.hpp"
#include "tests/capture/simulated_clock.hpp"
#include "types/error.hpp"

namespace depthscope::capture {
namespace {

using namespace std::chrono_literals;
using Kind = FaultEvent::Kind;

constexpr FrameFormat kYuv{PixelFormat::Yuv420p, 64, 48};
constexpr int kFrames = 20;
constexpr auto kPeriod = 40ms;  // 25 frames a second

class Paced : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(std::vector<FaultEvent> faults = {}, bool loop = false,
                                    int buffers = 4) {
    return openFileSource({.path = clip_,
                           .pacing = FileSourceSettings::Pacing::Clip,
                           .loop = loop,
                           .buffers = buffers,
                           .faults = std::move(faults)},
                          clock_);
  }
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    clip_ = *folder_ / "clip.mkv";
    writeVideo(clip_, kYuv, kFrames, 25, gradient);
  }
  static void TearDownTestSuite() { delete folder_; }
  std::chrono::nanoseconds sinceStart() const { return clock_.now() - start_; }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline std::filesystem::path clip_;
  SimulatedClock clock_;
  const PacingClock::TimePoint start_ = clock_.now();
};

TEST_F(Paced, EachFrameComesAtItsTimeFromTheFirstReadOn) {
  const auto source = open();
  clock_.advance(10s);  // whatever the program does before it reads
  const auto first_read = clock_.now();
  for (int i = 0; i < kFrames; ++i) {
    const ReadResult result = source->read(1s);
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.frame.sequence, static_cast<std::uint64_t>(i));
    EXPECT_EQ(clock_.now() - first_read, i * kPeriod);
    EXPECT_EQ(result.frame.capture_time, first_read + i * kPeriod);
    EXPECT_EQ(result.frame.planes[0].data[0], gradient(i, 0, 0, 0));
  }
  EXPECT_EQ(source->read(1s).status, SourceStatus::EndOfStream);
  EXPECT_EQ(source->read(1s).status, SourceStatus::EndOfStream);
  EXPECT_EQ(source->skipped(), 0u);
}

TEST_F(Paced, WaitsNoLongerThanItsTimeout) {
  const auto source = open();
  ASSERT_EQ(source->read(0ms).status, SourceStatus::Ok);
  EXPECT_EQ(source->read(0ms).status, SourceStatus::Timeout);
  EXPECT_EQ(sinceStart(), 0ms);
  EXPECT_EQ(source->read(15ms).status, SourceStatus::Timeout);
  EXPECT_EQ(sinceStart(), 15ms);
  EXPECT_EQ(source->read(-5ms).status, SourceStatus::Timeout);
  EXPECT_EQ(source->read(25ms).status, SourceStatus::Ok) << "due exactly at the deadline";
  EXPECT_EQ(sinceStart(), 40ms);
  EXPECT_EQ(source->read(std::chrono::nanoseconds::max()).status, SourceStatus::Ok);
  EXPECT_EQ(sinceStart(), 80ms);
}

TEST_F(Paced, TheNewestFrameWinsAndTheSkippedAreCounted) {
  const auto source = open();
  ASSERT_EQ(source->read(0ms).frame.sequence, 0u);
  clock_.advance(10 * kPeriod + 5ms);
  const ReadResult result = source->read(0ms);
  ASSERT_EQ(result.status, SourceStatus::Ok);
  EXPECT_EQ(result.frame.sequence, 10u);
  EXPECT_EQ(result.frame.planes[0].data[0], gradient(10, 0, 0, 0));
  EXPECT_EQ(result.frame.capture_time, start_ + 10 * kPeriod);
  EXPECT_EQ(source->skipped(), 9u);
  EXPECT_EQ(source->read(1s).frame.sequence, 11u);
  EXPECT_EQ(source->skipped(), 9u);
}

TEST_F(Paced, AReaderThatSleepsThroughTheEndGetsTheLastFrame) {
  const auto source = open();
  ASSERT_EQ(source->read(0ms).status, SourceStatus::Ok);
  clock_.advance(1h);
  EXPECT_EQ(source->read(0ms).frame.sequence, kFrames - 1u);
  EXPECT_EQ(source->skipped(), kFrames - 2u);
  EXPECT_EQ(source->read(0ms).status, SourceStatus::EndOfStream);
}

TEST_F(Paced, LoopGoesOnInNumberAndTime) {
  const auto source = open({}, true);
  for (std::uint64_t i = 0; i < 2 * kFrames + 5; ++i) {
    const ReadResult result = source->read(1s);
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_EQ(result.frame.sequence, i);
    EXPECT_EQ(sinceStart(), static_cast<int>(i) * kPeriod);
    EXPECT_DOUBLE_EQ(result.frame.media_time_s, static_cast<double>(i) / 25);
    EXPECT_EQ(result.frame.planes[0].data[0], gradient(static_cast<int>(i) % kFrames, 0, 0, 0));
  }
}

TEST_F(Paced, SignalLossTakesTheTimeItsFramesWouldHaveTaken) {
  const auto source = open({{Kind::SignalLost, 2, 3}});
  for (int i = 0; i < 8; ++i) {
    const ReadResult result = source->read(1s);
    EXPECT_EQ(result.status, i >= 2 && i < 5 ? SourceStatus::NoSignal : SourceStatus::Ok) << i;
    EXPECT_EQ(sinceStart(), i * kPeriod);
    if (result.status == SourceStatus::Ok) {
      EXPECT_EQ(result.frame.sequence, static_cast<std::uint64_t>(i));
    }
  }
  EXPECT_EQ(source->skipped(), 0u);
}

TEST_F(Paced, ALateFrameHoldsUpThoseBehindItAndTheNewestWins) {
  const auto source = open({{Kind::Late, 3, 1, 0, 0, 100.0}});
  for (int i = 0; i < 3; ++i) source->read(1s);
  const ReadResult result = source->read(1s);
  ASSERT_EQ(result.status, SourceStatus::Ok);
  EXPECT_EQ(sinceStart(), 3 * kPeriod + 100ms);
  EXPECT_EQ(result.frame.sequence, 5u);  // due at 200 ms, with 3 and 4 at 220 ms
  EXPECT_EQ(result.frame.capture_time, start_ + 5 * kPeriod);
  EXPECT_EQ(source->skipped(), 2u);
  EXPECT_EQ(source->read(1s).frame.sequence, 6u);
}

TEST_F(Paced, LongDelaysOfManyFramesDoNotStall) {
  const auto source = open({{Kind::Late, 2, 10, 0, 0, 500.0}});
  std::uint64_t last = 0;
  int shown = 0;
  for (ReadResult r = source->read(1s); r.status != SourceStatus::EndOfStream;
       r = source->read(1s)) {
    if (r.status != SourceStatus::Ok) continue;
    EXPECT_TRUE(shown == 0 || r.frame.sequence > last);
    last = r.frame.sequence;
    ++shown;
  }
  EXPECT_EQ(last, kFrames - 1u);
  EXPECT_EQ(shown + source->skipped(), kFrames);
}

TEST_F(Paced, ResizeIsSaidWithTheFrame) {
  const auto source = open({{Kind::Resize, 1, 1, 32, 20}});
  EXPECT_FALSE(source->read(1s).format_changed);
  const ReadResult resized = source->read(1s);
  EXPECT_TRUE(resized.format_changed);
  EXPECT_EQ(resized.frame.format.width, 32);
  EXPECT_TRUE(source->read(1s).format_changed);
}

TEST_F(Paced, FramesWithoutAFreeBufferAreSkippedAndItRecovers) {
  const auto source = open({}, false, 2);
  ReadResult first = source->read(1s), second = source->read(1s);
  ASSERT_EQ(second.frame.sequence, 1u);
  clock_.advance(5 * kPeriod);
  EXPECT_EQ(source->read(0ms).status, SourceStatus::Timeout);
  EXPECT_EQ(source->skipped(), 5u);
  first.frame = {};
  const ReadResult next = source->read(1s);
  ASSERT_EQ(next.status, SourceStatus::Ok);
  EXPECT_EQ(next.frame.sequence, 7u);
  EXPECT_EQ(second.frame.planes[0].data[0], gradient(1, 0, 0, 0)) << "a held frame was written to";
}

TEST_F(Paced, AFrameOutlivesItsSource) {
  auto source = open();
  const ReadResult result = source->read(1s);
  source.reset();
  EXPECT_EQ(result.frame.planes[0].data[0], gradient(0, 0, 0, 0));
}

TEST_F(Paced, CanBeClosedAtAnyTime) {
  open().reset();
  const auto source = open({}, true);
  source->read(1s);
}

TEST_F(Paced, BadInputIsRefusedAtTheStart) {
  EXPECT_THROW(
      openFileSource({.path = *folder_ / "none.mp4", .pacing = FileSourceSettings::Pacing::Clip},
                     clock_),
      InputError);
}

TEST_F(Paced, ByTheRealClockEveryFrameIsShownOrCountedAsSkipped) {
  const auto source =
      openFileSource({.path = clip_, .pacing = FileSourceSettings::Pacing::Clip, .fps = 1000});
  std::uint64_t shown = 0, next = 0;
  for (;;) {
    const ReadResult result = source->read(10s);
    if (result.status == SourceStatus::EndOfStream) break;
    ASSERT_EQ(result.status, SourceStatus::Ok);
    EXPECT_GE(result.frame.sequence, next);
    EXPECT_LE(result.frame.capture_time, std::chrono::steady_clock::now());
    next = result.frame.sequence + 1;
    ++shown;
  }
  EXPECT_EQ(shown + source->skipped(), kFrames);
  EXPECT_EQ(next, kFrames) << "the last frame is always shown";
}

}  // namespace
}  // namespace depthscope::capture
