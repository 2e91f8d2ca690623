#include "platform/daemon/restart_policy.hpp"

#include <gtest/gtest.h>

namespace depthscope::platform {
namespace {

using namespace std::chrono_literals;

TEST(RestartPolicy, WaitsTwiceAsLongEachTimeUpToTheLimit) {
  RestartPolicy policy(200ms, 1s);
  RestartPolicy::Clock::time_point now{};
  for (const auto wait : {200ms, 400ms, 800ms, 1000ms, 1000ms}) {
    policy.started(now);
    now += 10ms;
    EXPECT_EQ(policy.ended(now) - now, wait);
  }
}

TEST(RestartPolicy, StartsSmallAgainAfterALongRun) {
  RestartPolicy policy(200ms, 1s);
  RestartPolicy::Clock::time_point now{};
  for (int i = 0; i < 4; ++i) {
    policy.started(now);
    policy.ended(now);
  }
  policy.started(now);
  now += 2s;
  EXPECT_EQ(policy.ended(now) - now, 200ms);
}

}  // namespace
}  // namespace depthscope::platform
