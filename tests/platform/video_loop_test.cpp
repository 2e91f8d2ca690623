#include "platform/daemon/video_loop.hpp"

#include <gmock/gmock.h>

#include "platform/allocation_hook.hpp"
#include "tests/platform/video_loop_fixture.hpp"

namespace depthscope::platform {
namespace {

using capture::SourceStatus;

std::size_t pixelAt(int x, int y, int width) {
  return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
              static_cast<std::size_t>(x));
}

/// What the n-th picture of a ScriptedSource looks like without overlay.
std::vector<std::uint8_t> plainPicture(std::uint64_t n) {
  fake::FakeKernel system;
  ScriptedSource source(system);
  for (std::uint64_t i = 0; i <= n; ++i) source.add(system.now());
  capture::ReadResult result;
  for (std::uint64_t i = 0; i <= n; ++i) result = source.read(milliseconds(1));
  std::vector<std::uint8_t> pixels(160 * 120 * 4);
  capture::toRgba(result.frame, pixels);
  return pixels;
}

int differences(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                int from_row, int to_row) {
  int n = 0;
  for (int y = from_row; y < to_row; ++y)
    for (int x = 0; x < 160; ++x) {
      const std::size_t at = pixelAt(x, y, 160);
      n += !std::equal(a.begin() + static_cast<long>(at), a.begin() + static_cast<long>(at) + 4,
                       b.begin() + static_cast<long>(at));
    }
  return n;
}
constexpr int below_mark = 30;

class VideoLoopTest : public VideoLoopFixture {
 protected:
  /// Pictures with AR, until an overlay lies over them.
  void startAr() {
    link.setAlive(true);
    showPicture(false);
    sendSurface();
    for (int i = 1; i < 25; ++i) showPicture(true);
    ASSERT_GT(differences(last().pixels, plainPicture(24), below_mark, 120), 500);
  }
};

TEST_F(VideoLoopTest, EveryPictureGoesOutOnceAndInOrder) {
  for (int i = 0; i < 50; ++i) showPicture(false);
  ASSERT_EQ(display.shown.size(), 50u);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_EQ(display.shown[i].index, static_cast<long>(i));
  EXPECT_EQ(report.frames.load(), 50u);
  EXPECT_EQ(report.presented.load(), 50u);
}

TEST_F(VideoLoopTest, OutsideTheMarkAPictureWithoutArIsThePictureThatCameIn) {
  for (int i = 0; i < 5; ++i) {
    showPicture(false);
    EXPECT_EQ(
        differences(last().pixels, plainPicture(static_cast<std::uint64_t>(i)), below_mark, 120),
        0);
  }
}

TEST_F(VideoLoopTest, TheOverlayIsGoneWithinItsAgeLimitWhenPosesStop) {
  startAr();
  const Time stopped = next;
  for (int i = 0; i < 12; ++i) {
    showPicture(false);
    const bool covered =
        differences(last().pixels, plainPicture(static_cast<std::uint64_t>(25 + i)), below_mark,
                    120) > 0;
    // The last pose is of the picture before the one shown at `stopped`.
    const auto age = next - (stopped - milliseconds(33));
    EXPECT_EQ(covered, age < milliseconds(120)) << i;
  }
  EXPECT_EQ(static_cast<overlay::Status>(report.overlay_status.load()), overlay::Status::Stale);
}

/// How strongly the overlay is seen in the n-th picture: levels by which it differs, in all.
long strength(const std::vector<std::uint8_t>& shown, std::uint64_t n) {
  const auto plain = plainPicture(n);
  long sum = 0;
  for (std::size_t i = pixelAt(0, below_mark, 160); i < plain.size(); ++i)
    sum += std::abs(shown[i] - plain[i]);
  return sum;
}

TEST_F(VideoLoopTest, TheOverlayFadesWithinItsAgeLimitWithTheArProcess) {
  startAr();
  long before = strength(last().pixels, 24);
  link.setAlive(false);
  for (std::uint64_t n = 25; n < 27; ++n) {
    showPicture(true);
    const long now = strength(last().pixels, n);
    EXPECT_LT(now, before) << n;
    EXPECT_GT(now, 0) << n;
    EXPECT_EQ(static_cast<overlay::Status>(report.overlay_status.load()), overlay::Status::NoAr);
    before = now;
  }
  showPicture(true);  // the last pose is of 132 ms before
  EXPECT_EQ(strength(last().pixels, 27), 0);
  link.setAlive(true);
  showPicture(true);
  EXPECT_EQ(strength(last().pixels, 28), 0) << "the surface was another map's";
  sendSurface();
  for (int i = 0; i < 20; ++i) showPicture(true);
  EXPECT_GT(differences(last().pixels, plainPicture(48), below_mark, 120), 500);
}

TEST_F(VideoLoopTest, AnArProcessThatIsBackAtOnceHasNothingOfTheLastOne) {
  startAr();
  link.setAlive(false);
  link.setAlive(true);
  showPicture(true);
  EXPECT_EQ(strength(last().pixels, 25), 0);
}

TEST_F(VideoLoopTest, TheOverlayFadesWhenTheTrackIsLost) {
  startAr();
  long before = strength(last().pixels, 24);
  const std::uint64_t tracked = report.tracked.load();
  for (std::uint64_t n = 25; n < 27; ++n) {
    sendPose(sequence - 1, TrackingState::Lost);
    showPicture(false);
    const long now = strength(last().pixels, n);
    EXPECT_LT(now, before) << n;
    EXPECT_GT(now, 0) << n;
    EXPECT_EQ(static_cast<overlay::Status>(report.overlay_status.load()), overlay::Status::Lost);
    before = now;
  }
  sendPose(sequence - 1, TrackingState::Lost);
  showPicture(false);
  EXPECT_EQ(strength(last().pixels, 27), 0);
  EXPECT_EQ(report.tracked.load(), tracked);
}

TEST_F(VideoLoopTest, AGraphicsDriverThatHangsCostsTheOverlayAndNotThePicture) {
  startAr();
  layers.hung = true;
  const std::size_t before = display.shown.size();
  for (int i = 0; i < 10; ++i) showPicture(true);
  EXPECT_EQ(display.shown.size(), before + 10);
  EXPECT_EQ(differences(last().pixels, plainPicture(34), below_mark, 120), 0);
  EXPECT_GT(differences(last().pixels, plainPicture(34), 0, below_mark), 100) << "marked as stale";
  EXPECT_GT(report.late_overlays.load(), 0u);
  layers.hung = false;
  showPicture(true);
  EXPECT_GT(differences(last().pixels, plainPicture(35), below_mark, 120), 500);
}

TEST_F(VideoLoopTest, ADisplayThatLaysOverlaysOverByItselfShowsTheSame) {
  startAr();
  for (int i = 0; i < 6; ++i) showPicture(true);
  const auto composed = last().pixels;
  SetUp();
  display.planes = true;
  for (int i = 0; i < 6; ++i) showPicture(true);
  EXPECT_EQ(display.direct, 6);
  // The pattern of the pictures moves on by one each: the overlay's own pixels are compared by how
  // much of the picture they leave.
  EXPECT_EQ(differences(last().pixels, plainPicture(36), below_mark, 120),
            differences(composed, plainPicture(30), below_mark, 120));
  link.setAlive(false);
  for (int i = 0; i < 4; ++i) showPicture(true);  // it fades
  EXPECT_EQ(differences(last().pixels, plainPicture(40), below_mark, 120), 0);
  EXPECT_GT(differences(last().pixels, plainPicture(40), 0, below_mark), 100) << "the mark";
}

TEST_F(VideoLoopTest, WhatTheDisplaysPlanesDoNotTakeIsComposed) {
  display.planes = true;
  showPicture(false);
  display.refuse = true;
  showPicture(false);
  EXPECT_EQ(display.direct, 1);
  EXPECT_EQ(differences(last().pixels, plainPicture(1), below_mark, 120), 0);
  display.refuse = false;
  display.lose = true;
  const auto given_up = report.given_up.load();
  showPicture(false);
  EXPECT_EQ(report.given_up.load(), given_up + 1);
  display.lose = false;
  showPicture(false);
  EXPECT_EQ(display.direct, 2);
  // The last picture stays, marked, when no new one comes: it went past the processor, but not out
  // of reach.
  const auto plain = plainPicture(3);
  ASSERT_TRUE(loop->turn());
  EXPECT_EQ(last().pixels[pixelAt(1, 110, 160)], plain[pixelAt(1, 110, 160)] / 2);
}

TEST_F(VideoLoopTest, AMissingPictureIsMarkedWithin100msAndThenReplacedByAFaultPicture) {
  showPicture(false);
  const Time last_picture = last().at;
  const auto plain = plainPicture(0);
  ASSERT_TRUE(loop->turn());
  EXPECT_LE(last().at - last_picture, milliseconds(100));
  EXPECT_EQ(last().pixels[pixelAt(1, 110, 160)], plain[pixelAt(1, 110, 160)] / 2) << "darkened";
  EXPECT_EQ(report.stale.load(), 1u);
  while (last().at - last_picture < milliseconds(1200)) ASSERT_TRUE(loop->turn());
  EXPECT_LT(last().pixels[pixelAt(1, 110, 160)], 20) << "dark";
  EXPECT_GE(report.faults.load(), 12u);
}

TEST_F(VideoLoopTest, EveryFaultHasAPictureOfItsOwnAndAGoodPictureComesAtOnceAfterIt) {
  std::vector<std::vector<std::uint8_t>> seen;
  for (SourceStatus status : {SourceStatus::NoDevice, SourceStatus::NoCable, SourceStatus::NoSignal,
                              SourceStatus::UnstableSync, SourceStatus::UnsupportedMode,
                              SourceStatus::PermissionDenied, SourceStatus::ReadError}) {
    next += milliseconds(33);
    source.add(next, status);
    ++sequence;
    ASSERT_TRUE(loop->turn());
    EXPECT_THAT(seen, testing::Not(testing::Contains(last().pixels)));
    seen.push_back(last().pixels);
    showPicture(false);
    EXPECT_EQ(differences(last().pixels, plainPicture(static_cast<std::uint64_t>(sequence - 1)),
                          below_mark, 120),
              0);
  }
}

TEST_F(VideoLoopTest, ADamagedPictureIsShownAndSaidToBeDamaged) {
  link.setAlive(true);
  showPicture(false);
  const auto sound = last().pixels;
  next += milliseconds(33);
  source.add(next, SourceStatus::Ok, true);
  ASSERT_TRUE(loop->turn());
  EXPECT_EQ(differences(last().pixels, plainPicture(1), below_mark, 120), 0);
  int differing = 0;
  for (int x = 60; x < 160; ++x) {  // right of the mark's own text
    const std::size_t at = pixelAt(x, 8, 160);
    const auto plain = plainPicture(1);
    differing += last().pixels[at] != plain[at];
  }
  EXPECT_GT(differing, 20);
}

TEST_F(VideoLoopTest, APictureOfAnotherSizeGoesOutWithoutAr) {
  startAr();
  source.resize(200, 90);
  showPicture(true);
  EXPECT_EQ(last().width, 200);
  EXPECT_EQ(last().height, 90);
  EXPECT_EQ(static_cast<overlay::Status>(report.overlay_status.load()), overlay::Status::NoAr);
  source.resize(160, 120);
  showPicture(true);
  showPicture(true);
  EXPECT_EQ(static_cast<overlay::Status>(report.overlay_status.load()), overlay::Status::Tracking);
}

TEST_F(VideoLoopTest, ABusyDisplayCostsThePictureAndIsCounted) {
  showPicture(false);
  display.busy = true;
  showPicture(false);
  display.busy = false;
  showPicture(false);
  EXPECT_EQ(display.shown.size(), 2u);
  EXPECT_EQ(report.given_up.load(), 1u);
}

TEST_F(VideoLoopTest, TheStagesOfEachPictureAddUpToItsDelay) {
  for (int i = 0; i < 61; ++i) showPicture(false);
  FrameClockSummary times;
  ASSERT_TRUE(report.times.read(times));
  EXPECT_EQ(times.video_delay.count, 61u);
  EXPECT_NEAR(times.video_delay.p50, 2, 0.05) << "the time that the display took";
  EXPECT_NEAR(times.submit.p50, 2, 0.05);
  EXPECT_EQ(times.dequeue.max, 0);
  EXPECT_EQ(times.shown_delay.count, 61u) << "as the display told";
  EXPECT_NEAR(times.shown_delay.p50, 12, 0.2);
  EXPECT_EQ(times.overlay_age.count, 0u);
}

TEST_F(VideoLoopTest, AllocatesNothingOnceWarm) {
  if (!countedAllocations()) GTEST_SKIP() << "the sanitizer owns the allocation functions";
  startAr();
  display.keep = false;
  // The driver's and the compositor's part runs in another thread in the program: here it hangs.
  layers.hung = true;
  next += milliseconds(33);
  for (int i = 0; i < 3; ++i) source.add(next += milliseconds(33));
  const auto before = countedAllocations();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(loop->turn());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(loop->turn()) << "stale, then fault pictures";
  EXPECT_EQ(countedAllocations(), before);
}

}  // namespace
}  // namespace depthscope::platform
