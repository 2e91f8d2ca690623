// In the style of SQLite: the k-th system call of a run fails, for every k, once and for ever
// after; the whole way of the picture, from capture card to monitor, must survive it. What must
// hold each time:
//   - no turn of the video loop throws, ends the loop or takes long;
//   - the monitor never shows an old picture as if it were live;
//   - pictures are back within 500 ms once calls work again;
//   - nothing that was opened or mapped is left behind.
#include <gtest/gtest.h>

#include <cerrno>

#include "tests/platform/simulated_box.hpp"

namespace depthscope::platform {
namespace {

using fake::FaultPlan;

constexpr auto run_time = milliseconds(250);
constexpr auto recovery_limit = milliseconds(500);
// A picture may wait for the next vblank, and the one before stays for as long as it is new.
constexpr auto live_limit = milliseconds(100 + 50);

struct Kind {
  const char* name;
  FaultPlan plan;
};
const Kind kinds[] = {
    {"EIO", {.error = EIO}},
    {"ENODEV", {.error = ENODEV}},
    {"EAGAIN", {.error = EAGAIN}},
    {"EINTR", {.error = EINTR}},
    {"EINVAL", {.error = EINVAL}},
    {"ENOMEM", {.error = ENOMEM}},
    {"short", {.kind = FaultPlan::Kind::Short}},
    {"late", {.kind = FaultPlan::Kind::Late, .delay = milliseconds(60)}},
};

/// Which calls fail: one, all after it, or all after it to one of the two devices.
struct Extent {
  const char* name;
  bool forever;
  const char* under;
};
const Extent extents[] = {{"Once", false, ""},
                          {"ForEver", true, ""},
                          {"ForEverOnTheCaptureCard", true, "/dev/video"},
                          {"ForEverOnTheMonitor", true, "/dev/dri"}};

/// Calls that the scenario makes when nothing fails.
std::uint64_t callsOfACleanRun(const Extent& extent) {
  SimulatedBox box;
  FaultPlan none;
  none.under = extent.under;
  box.kernel.inject(none);
  const Time end = box.kernel.now() + run_time;
  box.start();
  box.runUntil(end);
  EXPECT_GT(box.report.frames.load(), 8u);
  return box.kernel.calls();
}

class FaultSweep : public testing::TestWithParam<std::tuple<int, int>> {
 protected:
  /// One run with one fault. False when something did not hold.
  static bool survives(const Kind& kind, std::uint64_t k, const Extent& extent) {
    SimulatedBox box;
    FaultPlan plan = kind.plan;
    plan.call = k;
    plan.forever = extent.forever;
    plan.under = extent.under;
    if (extent.forever)
      plan.delay = std::min(plan.delay, std::chrono::nanoseconds(milliseconds(1)));
    box.kernel.inject(plan);
    const Time end = box.kernel.now() + run_time;
    box.start();
    box.runUntil(end);
    const auto unmarked = box.longest_unmarked;
    box.kernel.inject({});
    EXPECT_LE(box.recover(), recovery_limit);
    EXPECT_LE(box.longest_turn, milliseconds(250));
    // Where the monitor's own calls fail, nothing can be said on it.
    const bool monitor_works = !extent.forever || extent.under == std::string_view("/dev/video");
    if (monitor_works) {
      EXPECT_LE(unmarked, live_limit + plan.delay);
    }
    EXPECT_TRUE(box.displayWorks());
    box.stop();
    EXPECT_EQ(box.kernel.openDescriptors(), 0u);
    EXPECT_EQ(box.kernel.mappings(), 0u);
    EXPECT_EQ(box.kernel.misuses(), 0u);
    return !HasFailure();
  }
};

TEST_P(FaultSweep, TheKthCallFailsForEveryK) {
  const Kind& kind = kinds[std::get<0>(GetParam())];
  const Extent& extent = extents[std::get<1>(GetParam())];
  const std::uint64_t calls = callsOfACleanRun(extent);
  for (std::uint64_t k = 1; k <= calls; ++k)
    ASSERT_TRUE(survives(kind, k, extent))
        << "call " << k << " of " << calls << ": " << kind.name << " " << extent.name;
  std::printf("%s %s: %llu faults injected, %llu survived\n", kind.name, extent.name,
              static_cast<unsigned long long>(calls), static_cast<unsigned long long>(calls));
}

INSTANTIATE_TEST_SUITE_P(EveryKind, FaultSweep,
                         testing::Combine(testing::Range(0, static_cast<int>(std::size(kinds))),
                                          testing::Range(0, static_cast<int>(std::size(extents)))),
                         [](const auto& run) {
                           return std::string(kinds[std::get<0>(run.param)].name) +
                                  extents[std::get<1>(run.param)].name;
                         });

}  // namespace
}  // namespace depthscope::platform
