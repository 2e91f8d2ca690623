#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <new>

#include "kernel/system_calls.hpp"

namespace depthscope::kernel {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(BellTest, ARingBeforeTheWaitIsNotMissed) {
  Bell bell;
  const std::uint32_t rings = bell.rings();
  bell.ring();
  EXPECT_EQ(realSystemCalls().waitForRing(bell, rings, seconds(10)), 0);
}

TEST(BellTest, TheWaitEndsWithItsLimit) {
  const Bell bell;
  EXPECT_EQ(realSystemCalls().waitForRing(bell, bell.rings(), milliseconds(5)), -ETIMEDOUT);
  EXPECT_EQ(realSystemCalls().waitForRing(bell, bell.rings(), milliseconds(-5)), -ETIMEDOUT);
}

TEST(BellTest, WakesAnotherProcess) {
  void* memory =
      ::mmap(nullptr, 2 * sizeof(Bell), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  Bell* there = new (memory) Bell;
  Bell* back = new (static_cast<Bell*>(memory) + 1) Bell;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const int waited = realSystemCalls().waitForRing(*there, 0, seconds(10));
    back->ring();
    ::_exit(waited == 0 ? 0 : 1);
  }
  there->ring();
  EXPECT_EQ(realSystemCalls().waitForRing(*back, 0, seconds(10)), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  ::munmap(memory, 2 * sizeof(Bell));
}

}  // namespace
}  // namespace depthscope::kernel
