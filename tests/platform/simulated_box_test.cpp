// The way of the picture from capture card to monitor on a simulated clock: how long it takes, and
// what the monitor shows when something is wrong with the source.
#include "tests/platform/simulated_box.hpp"

#include <set>

namespace depthscope::platform {
namespace {

constexpr int bits = 16, bit_width = box_width / bits;
constexpr int clock_row = box_height - 4;  // below mark and notices

/// A picture that carries its own number: bits from left to right, white for 1.
fake::Rgb binaryClock(int x, int /*y*/, std::uint64_t index) {
  const bool one = index >> std::min(x / bit_width, bits - 1) & 1;
  const double level = one ? 0.9 : 0.3;
  return {level, level, level};
}

std::uint64_t readClock(FakeKmsCard& monitor) {
  std::uint64_t index = 0;
  for (int bit = 0; bit < bits; ++bit)
    if ((monitor.pixel(bit * bit_width + bit_width / 2, clock_row) & 0xff) > 0x90)
      index |= std::uint64_t{1} << bit;
  return index;
}

TEST(SimulatedBoxTest, EveryPictureReachesTheMonitorWithinTwoFrameTimes) {
  SimulatedBox box;
  box.card.setScene([](int x, int y, std::uint64_t i, int) { return binaryClock(x, y, i); });
  box.start();
  box.runUntil(box.kernel.now() + milliseconds(500));
  // From here on each new number on the monitor is the one after, and is there soon after its
  // capture.
  const std::uint64_t first = readClock(box.monitor);
  std::uint64_t last = first;
  const Time start = box.kernel.now();
  while (box.kernel.now() - start < std::chrono::seconds(5)) {
    box.turn();
    const std::uint64_t now = readClock(box.monitor);
    ASSERT_TRUE(now == last || now == last + 1) << last << " then " << now;
    last = now;
  }
  EXPECT_NEAR(static_cast<double>(last - first), 5 * box_rate, 2);
  FrameClockSummary times;
  ASSERT_TRUE(box.report.times.read(times));
  EXPECT_GT(times.shown_delay.count, 200u);
  EXPECT_LE(times.shown_delay.p99, 2000 / box_rate) << "but for the first, which sets the mode";
  EXPECT_LE(times.video_delay.p99, 1000 / box_rate);
}

std::vector<std::uint32_t> screen(FakeKmsCard& monitor) {
  std::vector<std::uint32_t> pixels;
  for (int y = 0; y < box_height; ++y)
    for (int x = 0; x < box_width; ++x) pixels.push_back(monitor.pixel(x, y));
  return pixels;
}

TEST(SimulatedBoxTest, EveryFaultOfTheSourceHasItsPictureWithin100msAndRecoversWithin500ms) {
  using Signal = FakeV4l2Card::Signal;
  struct Fault {
    const char* name;
    void (*begin)(FakeV4l2Card&);
    void (*end)(FakeV4l2Card&);
  };
  const Fault faults[] = {
      {"no cable", [](auto& c) { c.setSignal(Signal::NoCable); },
       [](auto& c) { c.setSignal(Signal::Good); }},
      {"no signal", [](auto& c) { c.setSignal(Signal::Missing); },
       [](auto& c) { c.setSignal(Signal::Good); }},
      {"unstable sync", [](auto& c) { c.setSignal(Signal::Unlocked); },
       [](auto& c) { c.setSignal(Signal::Good); }},
      {"unsupported mode", [](auto& c) { c.setSignal(Signal::OutOfRange); },
       [](auto& c) { c.setSignal(Signal::Good); }},
      {"no frames", [](auto& c) { c.stall(true); }, [](auto& c) { c.stall(false); }},
      {"damaged", [](auto& c) { c.damageNext(1000000); }, [](auto& c) { c.damageNext(0); }},
      {"disconnect", [](auto& c) { c.disconnect(); }, [](auto& c) { c.reconnect(); }},
  };
  std::set<std::vector<std::uint32_t>> pictures;
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.name);
    SimulatedBox box;
    box.start();
    box.runUntil(box.kernel.now() + milliseconds(400));
    fault.begin(box.card);
    const Time begun = box.kernel.now();
    box.runUntil(begun + milliseconds(1600));
    EXPECT_LE(box.longest_unmarked, milliseconds(150));
    pictures.insert(screen(box.monitor));
    fault.end(box.card);
    EXPECT_LE(box.recover(), milliseconds(500));
    box.stop();
    EXPECT_EQ(box.kernel.openDescriptors(), 0u);
  }
  EXPECT_EQ(pictures.size(), std::size(faults)) << "each has a picture of its own";
}

TEST(SimulatedBoxTest, AnotherModeComesThroughWithin500ms) {
  SimulatedBox box;
  box.start();
  box.runUntil(box.kernel.now() + milliseconds(400));
  box.card.setMode(fake::timingsSmall(80, 60, 50));
  EXPECT_LE(box.recover(), milliseconds(500));
  box.runUntil(box.kernel.now() + milliseconds(200));
  ASSERT_NE(box.monitor.mode(), nullptr);
  EXPECT_EQ(box.monitor.mode()->hdisplay, 80);
}

TEST(SimulatedBoxTest, PermissionDeniedIsSaidAndPicturesComeOnceItIsGranted) {
  SimulatedBox box;
  box.card.refuseOpen(EACCES);
  box.start();
  box.runUntil(box.kernel.now() + milliseconds(400));
  EXPECT_EQ(static_cast<capture::SourceStatus>(box.report.source_status.load()),
            capture::SourceStatus::PermissionDenied);
  EXPECT_EQ(box.report.frames.load(), 0u);
  box.card.refuseOpen(0);
  EXPECT_LE(box.recover(), milliseconds(500));
}

}  // namespace
}  // namespace depthscope::platform
