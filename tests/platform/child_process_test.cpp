#include "platform/daemon/child_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <system_error>

#include "platform/unique_fd.hpp"

namespace depthscope::platform {
namespace {

/// Waits for the child's end; the loop is over as soon as it ended.
int endOf(ChildProcess& child) {
  int status = 0;
  while (!child.ended(status)) ::usleep(1000);
  return status;
}

TEST(ChildProcess, HandsDescriptorsOverAtTheirNumbers) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const UniqueFd in(ends[0]);
  UniqueFd out(ends[1]);
  const std::array<std::pair<int, int>, 1> descriptors{{{out.get(), 9}}};
  ChildProcess child({"/bin/sh", "-c", "echo hello >&9"}, descriptors);
  out.reset();
  char buffer[16] = {};
  EXPECT_EQ(::read(in.get(), buffer, sizeof buffer), 6);
  EXPECT_STREQ(buffer, "hello\n");
  EXPECT_EQ(describeEnd(endOf(child)), "exit status 0");
  EXPECT_FALSE(child.running());
}

TEST(ChildProcess, TellsHowItEnded) {
  ChildProcess child({"/bin/sh", "-c", "exit 7"}, {});
  EXPECT_EQ(describeEnd(endOf(child)), "exit status 7");
  child = ChildProcess({"/bin/sh", "-c", "kill -9 $$"}, {});
  EXPECT_EQ(describeEnd(endOf(child)), "signal 9");
}

TEST(ChildProcess, IsKilledWithItsOwner) {
  pid_t pid = 0;
  {
    ChildProcess child({"/bin/sleep", "1000"}, {});
    pid = child.pid();
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_NE(::kill(pid, 0), 0);
}

TEST(ChildProcess, SaysWhenThereIsNoSuchProgram) {
  EXPECT_THROW(ChildProcess({"/no/such/program"}, {}), std::system_error);
}

}  // namespace
}  // namespace depthscope::platform
