#include <gtest/gtest.h>

#include "platform/daemon/life_signs.hpp"

namespace depthscope::platform {
namespace {

using Message = WatchdogFeed::Message;
using std::chrono::milliseconds;

TEST(WatchdogFeed, SaysReadyWithTheFirstPictureAndAliveOnlyWhilePicturesGoOut) {
  WatchdogFeed feed(std::chrono::seconds(2));
  WatchdogFeed::Time now{};
  for (int i = 0; i < 100; ++i) EXPECT_EQ(feed.next(now += milliseconds(25), 0), Message::None);
  EXPECT_EQ(feed.next(now, 1), Message::Ready);
  int alive = 0;
  for (std::uint64_t i = 2; i < 82; ++i)
    alive += feed.next(now += milliseconds(25), i) == Message::Alive;
  EXPECT_EQ(alive, 4) << "four times in the two seconds that systemd waits";
  feed.next(now += milliseconds(500), 90);
  for (int i = 0; i < 400; ++i) EXPECT_EQ(feed.next(now += milliseconds(25), 90), Message::None);
  EXPECT_EQ(feed.next(now, 91), Message::Alive);
}

TEST(WatchdogFeed, WithoutAWatchdogOnlyTheStartIsTold) {
  WatchdogFeed feed(std::chrono::microseconds(0));
  EXPECT_EQ(feed.next(WatchdogFeed::Time{}, 1), Message::Ready);
  for (std::uint64_t i = 2; i < 100; ++i)
    EXPECT_EQ(feed.next(WatchdogFeed::Time{} + i * milliseconds(100), i), Message::None);
}

}  // namespace
}  // namespace depthscope::platform
