// display.registration on a simulated clock: an AR process that takes its time, hangs, dies or
// floods. In no case may it cost a picture.
#include <gtest/gtest.h>

#include "tests/platform/video_loop_fixture.hpp"

namespace depthscope::platform {
namespace {

constexpr milliseconds frame_interval{33};
constexpr float exact_wait = 0.8f;
// What a picture may be late by: the wait, 2 ms of the display, and the calls themselves.
constexpr milliseconds exact_bound{27 + 2 + 1};

/// Plays the AR process: finds each picture's pose some time after the picture was published, and
/// rings.
class PacedTracker final : public fake::FakeFile {
 public:
  PacedTracker(const SharedMemory& memory, fake::FakeKernel& system)
      : memory_(memory),
        system_(system),
        frames_(memory),
        pixels_(160 * 120),
        color_(memory.colorSize().pixels()) {}

  short events() override {
    work();
    if (flood) memory_.block().new_pose.ring();
    return 0;
  }
  std::optional<Time> nextEvent() override {
    work();
    if (!busy_ || stopped) return std::nullopt;
    return due_;
  }
  /// Looks at the clock: takes the newest picture, or gives its pose when it is due.
  void work() {
    if (busy_ && !stopped && system_.now() >= due_) {
      busy_ = false;
      PoseEstimate pose;
      pose.frame = info_.frame;
      pose.state = TrackingState::Tracking;
      pose.confidence = 1;
      memory_.block().pose.write(encodePose(pose));
      memory_.block().new_pose.ring();
    }
    if (busy_ || stopped || !frames_.takeNewest(pixels_, color_, info_)) return;
    busy_ = true;
    due_ = system_.now() + takes;
  }

  std::chrono::nanoseconds takes = milliseconds(12);
  bool stopped = false, flood = false;

 private:
  const SharedMemory& memory_;
  fake::FakeKernel& system_;
  FrameRingReader frames_;
  std::vector<std::uint8_t> pixels_;
  std::vector<Rgb> color_;
  WireFrameInfo info_{};
  bool busy_ = false;
  Time due_{};
};

class RegistrationTest : public VideoLoopFixture {
 protected:
  void SetUp() override { use(true); }
  void use(bool exact) {
    settings.overlay_wait = exact ? exact_wait : 0.5f;
    painter.waitForPoses(exact ? &wait : nullptr);
    makeLoop();
    link.setAlive(true);
    sendPose(0);
  }
  /// Pictures at their rate, while the tracker works. The latest that one went out.
  std::chrono::nanoseconds play(int pictures) {
    std::chrono::nanoseconds latest{0};
    for (int i = 0; i < pictures; ++i) {
      next += frame_interval;
      source.add(next);
      ++sequence;
      if (next > system.now()) system.advance(next - system.now());
      tracker->work();
      EXPECT_TRUE(loop->turn());
      latest = std::max<std::chrono::nanoseconds>(latest, last().at - next);
      tracker->work();
    }
    return latest;
  }
  FrameClockSummary times() {
    while (report.frames.load() % 30 != 1) play(1);
    FrameClockSummary summary;
    EXPECT_TRUE(report.times.read(summary));
    return summary;
  }
  void expectEveryPictureOnce() {
    ASSERT_EQ(display.shown.size(), static_cast<std::size_t>(sequence));
    for (std::size_t i = 0; i < display.shown.size(); ++i)
      EXPECT_EQ(display.shown[i].index, static_cast<std::int64_t>(i));
  }
  overlay::Status status() const {
    return static_cast<overlay::Status>(report.overlay_status.load());
  }

  PacedTracker* tracker = new PacedTracker(memory, system);  // the kernel's, below
  const int tracker_file = system.install(std::unique_ptr<fake::FakeFile>(tracker));
  PoseWait wait{memory, system};
};

TEST_F(RegistrationTest, ExactShowsEachPictureWithItsOwnPose) {
  sendSurface();
  EXPECT_LE(play(60), exact_bound);
  const FrameClockSummary t = times();
  EXPECT_GE(t.overlay_age.count, 60u);
  EXPECT_EQ(t.overlay_age.max, 0) << "overlay and picture are of the same moment";
  EXPECT_NEAR(t.video_delay.p50, 14, 0.5) << "tracking and display";
  expectEveryPictureOnce();
}

TEST_F(RegistrationTest, LowestLatencyWaitsForNoPose) {
  use(false);
  play(60);
  const FrameClockSummary t = times();
  EXPECT_NEAR(t.video_delay.p50, 2, 0.2);
  EXPECT_NEAR(t.overlay_age.p50, 33, 1) << "the newest pose is of the picture before";
  expectEveryPictureOnce();
}

TEST_F(RegistrationTest, ASlowTrackerDelaysThePictureNoFurtherThanTheBound) {
  for (int ms : {25, 30, 45, 90, 300}) {
    tracker->takes = milliseconds(ms);
    EXPECT_LE(play(60), exact_bound) << ms;
  }
  expectEveryPictureOnce();
}

TEST_F(RegistrationTest, ALittleTooSlowATrackerLeavesThePredictedOverlay) {
  tracker->takes = milliseconds(30);
  play(60);
  EXPECT_EQ(status(), overlay::Status::Tracking);
  EXPECT_LE(times().overlay_age.max, 120);
}

TEST_F(RegistrationTest, AnArProcessThatHangsIsSoonNoLongerWaitedFor) {
  play(10);
  tracker->stopped = true;
  EXPECT_LE(play(4), exact_bound);
  EXPECT_LE(play(30), milliseconds(3)) << "no wait: nothing would come";
  EXPECT_EQ(status(), overlay::Status::Stale);
  tracker->stopped = false;
  play(4);
  EXPECT_EQ(status(), overlay::Status::Tracking);
  EXPECT_GT(play(10), milliseconds(10)) << "exact again";
  expectEveryPictureOnce();
}

TEST_F(RegistrationTest, AnArProcessThatDiesIsNotWaitedFor) {
  play(10);
  tracker->stopped = true;
  link.setAlive(false);
  EXPECT_LE(play(30), milliseconds(3));
  EXPECT_EQ(status(), overlay::Status::NoAr);
  expectEveryPictureOnce();
}

TEST_F(RegistrationTest, AFloodOfRingsEndsAtTheBound) {
  play(10);
  tracker->stopped = tracker->flood = true;
  EXPECT_LE(play(10), exact_bound);
  expectEveryPictureOnce();
}

TEST_F(RegistrationTest, AWaitThatTheSystemRefusesHoldsNothingUp) {
  play(10);
  fake::FaultPlan refused;
  refused.call = system.calls() + 1;
  refused.forever = true;
  refused.error = ENOSYS;
  system.inject(refused);
  EXPECT_LE(play(10), milliseconds(3));
  expectEveryPictureOnce();
}

}  // namespace
}  // namespace depthscope::platform
