// An AR process that went mad: whatever lies in the shared memory, the overlay is drawn or left
// out, and nothing else happens.
#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>

#include "tests/platform/video_loop_fixture.hpp"

namespace depthscope::platform {
namespace {

class ArLinkFuzz : public VideoLoopFixture {
 protected:
  std::span<seqlock::Word> words() {
    return {reinterpret_cast<seqlock::Word*>(&memory.block()), memory.bytes() / 8};
  }
  /// Interesting words: small counts, negative numbers, infinities, noise.
  std::uint64_t word() {
    switch (random() % 6) {
      case 0:
        return random() % 5;
      case 1:
        return ~std::uint64_t{0} - random() % 3;
      case 2:
        return 0x7ff0000000000000;  // infinity
      case 3:
        return 0x7fc000007fc00000;  // two floats that are no numbers
      case 4:
        return (random() % 2000) << 32 | random() % 2000;
      default:
        return random();
    }
  }
  void garbage(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) words()[i].store(word(), std::memory_order_relaxed);
  }
  void drawOnce() {
    source.add(next += milliseconds(33));
    ASSERT_TRUE(loop->turn());
    const ArLink::View view = link.view(next, camera.width, camera.height);
    if (view.state.status == overlay::Status::Tracking) {
      EXPECT_TRUE(view.state.T_camera_world.allFinite());
      EXPECT_TRUE(view.state.age_ms >= 0 && view.state.age_ms <= 120);
      EXPECT_TRUE(view.state.confidence >= 0 && view.state.confidence <= 1);
    }
    EXPECT_EQ(report.overlay_failures.load(), 0u);
  }

  std::mt19937_64 random{20170705};
};

TEST_F(ArLinkFuzz, GarbageInTheWholeMemory) {
  link.setAlive(true);
  for (int round = 0; round < 150; ++round) {
    garbage(0, words().size());
    drawOnce();
  }
  EXPECT_EQ(display.shown.size(), 150u);
  EXPECT_GT(link.rejected(), 0u);
}

TEST_F(ArLinkFuzz, SoundDataWithSomeWordsSpoilt) {
  link.setAlive(true);
  drawOnce();
  std::uint64_t rejected = 0;
  for (int round = 0; round < 300; ++round) {
    sendSurface();
    sendPose(round);
    // In the first part lie all counts, sizes, poses and labels; behind it pictures and surfaces.
    const std::size_t head = sizeof(SharedBlock) / 8;
    for (int i = 0; i < 3; ++i) {
      const bool in_head = random() % 2 == 0;
      const std::size_t at = in_head ? random() % head : head + random() % (words().size() - head);
      garbage(at, at + 1);
    }
    drawOnce();
    rejected = link.rejected();
  }
  EXPECT_GT(rejected, 0u) << "some of it was seen to be wrong";
}

TEST_F(ArLinkFuzz, AFloodOfGarbageWhileItIsRead) {
  link.setAlive(true);
  std::atomic<bool> done{false};
  std::thread flood([&] {
    std::mt19937_64 noise(5);
    std::uint32_t version = 0;
    while (!done) {
      for (int i = 0; i < 200; ++i)
        words()[noise() % words().size()].store(noise(), std::memory_order_relaxed);
      PoseEstimate pose;
      pose.frame = ++version;
      pose.state = TrackingState::Tracking;
      memory.block().pose.write(encodePose(pose));
      memory.block().surfaces_published.store(version, std::memory_order_release);
    }
  });
  for (int round = 0; round < 200; ++round) drawOnce();
  done = true;
  flood.join();
  EXPECT_EQ(display.shown.size(), 200u);
}

TEST_F(ArLinkFuzz, APoseOfAPictureThatWasNeverGivenOutIsNotDrawnBy) {
  link.setAlive(true);
  drawOnce();
  for (std::int64_t frame : {std::int64_t{-5}, std::int64_t{1000}, INT64_MAX, INT64_MIN}) {
    sendPose(frame);
    EXPECT_NE(link.view(next, 160, 120).state.status, overlay::Status::Tracking) << frame;
  }
  sendPose(0);
  EXPECT_EQ(link.view(next, 160, 120).state.status, overlay::Status::Tracking);
}

}  // namespace
}  // namespace depthscope::platform
