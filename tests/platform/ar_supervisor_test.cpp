// Real processes, the time as the test says.
#include "platform/daemon/ar_supervisor.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

namespace depthscope::platform {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class ArSupervisorTest : public testing::Test {
 protected:
  /// A shell stands in for the AR process; what the supervisor hands over is of no use to it.
  ArSupervisor supervisor(const std::string& script) {
    return ArSupervisor({"/bin/sh", "-c", script}, memory, settings);
  }
  /// Ticks without the time moving until `condition` holds, for a minute of real time at most.
  template <class Condition>
  bool tickUntil(ArSupervisor& ar, Condition&& condition) {
    for (int i = 0; i < 60000 && !condition(); ++i) {
      ar.tick(now);
      ::usleep(1000);
    }
    return condition();
  }

  SharedMemory memory = SharedMemory::create({64, 48, 1000, 2000});
  Settings settings;
  ArSupervisor::Clock::time_point now{seconds(100)};
};

TEST_F(ArSupervisorTest, ASilentProcessIsKilledAndReplacedWithoutBeingWaitedFor) {
  settings.daemon.heartbeat_timeout_s = 10;
  ArSupervisor ar = supervisor("while :; do sleep 1; done");
  ar.tick(now);
  const pid_t first = ar.pid();
  ASSERT_GT(first, 0);
  ASSERT_EQ(::kill(first, SIGSTOP), 0);
  ar.tick(now += milliseconds(9900));
  EXPECT_EQ(ar.pid(), first);
  now += milliseconds(200);
  ASSERT_TRUE(tickUntil(ar, [&] { return !ar.alive(); }));
  EXPECT_EQ(ar.restarts(), 0) << "not before the wait is over";
  now += seconds(1);
  ASSERT_TRUE(tickUntil(ar, [&] { return ar.alive(); }));
  EXPECT_NE(ar.pid(), first);
  EXPECT_EQ(ar.restarts(), 1);
}

TEST_F(ArSupervisorTest, AProcessThatTakesAllMemoryEndsByItselfAndIsReplaced) {
#ifdef DEPTHSCOPE_SANITIZED
  GTEST_SKIP() << "the sanitizer needs more memory than the limit lets its children have";
#endif
  settings.daemon.ar_memory_mb = 64;
  ArSupervisor ar = supervisor("x=0123456789abcdef; sleep 0.1; while :; do x=$x$x; done");
  ar.tick(now);
  ASSERT_GT(ar.pid(), 0);
  ASSERT_TRUE(tickUntil(ar, [&] { return !ar.alive(); })) << "the limit holds";
  now += seconds(1);
  ASSERT_TRUE(tickUntil(ar, [&] { return ar.alive(); }));
  EXPECT_EQ(ar.restarts(), 1);
}

TEST_F(ArSupervisorTest, AProgramThatIsNotThereIsTriedAgainAndNothingElseHappens) {
  ArSupervisor ar({"/no/such/program"}, memory, settings);
  for (int i = 0; i < 20; ++i) EXPECT_NO_THROW(ar.tick(now += seconds(1)));
  EXPECT_FALSE(ar.alive());
  EXPECT_FALSE(ar.send(encodeCommand(WireCommand::Reconstruct)));
}

}  // namespace
}  // namespace depthscope::platform
