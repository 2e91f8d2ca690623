#include "platform/daemon/overlay_deadline.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;
using Time = OverlayDeadline::Time;

TEST(OverlayDeadline, CountsFromWhenPicturesUsuallyCome) {
  OverlayDeadline deadline;
  const Time start{};
  for (int i = 0; i < 100; ++i) {
    const Time captured = start + i * milliseconds(33);
    EXPECT_EQ(deadline.next(captured, captured + milliseconds(5), milliseconds(10)),
              captured + milliseconds(15));
  }
}

TEST(OverlayDeadline, APictureThatWasHeldUpWaitsTheLess) {
  OverlayDeadline deadline;
  const Time start{};
  deadline.next(start, start + milliseconds(5), milliseconds(10));
  const Time captured = start + milliseconds(33);
  const Time late = deadline.next(captured, captured + milliseconds(12), milliseconds(10));
  EXPECT_NEAR(std::chrono::duration<double>(late - captured).count(), 0.015, 0.0005);
}

TEST(OverlayDeadline, FollowsASourceThatTakesLongerFromNowOn) {
  OverlayDeadline deadline;
  Time captured{};
  deadline.next(captured, captured, milliseconds(10));
  for (int i = 0; i < 100; ++i) {
    captured += milliseconds(33);
    deadline.next(captured, captured + milliseconds(20), milliseconds(10));
  }
  EXPECT_EQ(deadline.next(captured, captured + milliseconds(20), milliseconds(10)),
            captured + milliseconds(30));
}

}  // namespace
}  // namespace depthscope::platform
