#include "tests/fake_kernel/fake_kernel.hpp"

#include <gtest/gtest.h>

#include <array>

#include "kernel/mapping.hpp"
#include "kernel/owned_fd.hpp"

namespace depthscope::fake {
namespace {

using std::chrono::milliseconds;

/// Becomes readable at a set time and maps to four bytes.
class Timer final : public FakeDevice {
 public:
  explicit Timer(FakeKernel& kernel) : kernel_(kernel) {}
  int open(int, std::unique_ptr<FakeFile>& file) override {
    file = std::make_unique<File>(kernel_, ready_);
    return 0;
  }

  Time ready_{};

 private:
  struct File final : FakeFile {
    File(FakeKernel& owner, Time at) : kernel(owner), ready(at) {}
    short events() override { return kernel.now() >= ready ? POLLIN : 0; }
    std::optional<Time> nextEvent() override { return ready; }
    ssize_t read(std::span<std::byte> into) override { return static_cast<ssize_t>(into.size()); }
    std::shared_ptr<std::byte[]> map(std::size_t length, off_t, int&) override {
      return std::make_shared<std::byte[]>(length);
    }
    FakeKernel& kernel;
    Time ready;
  };
  FakeKernel& kernel_;
};

class FakeKernelTest : public testing::Test {
 protected:
  FakeKernel kernel;
  Timer timer{kernel};
};

TEST_F(FakeKernelTest, PollMovesTheClockToTheEventAndNoFarther) {
  timer.ready_ = kernel.now() + milliseconds(30);
  kernel.plug("/dev/timer", timer);
  const kernel::OwnedFd fd(kernel, kernel.open("/dev/timer", 0));
  std::array<pollfd, 1> wait{{{fd.get(), POLLIN, 0}}};
  EXPECT_EQ(kernel.poll(wait, milliseconds(10)), 0);
  EXPECT_EQ(kernel.poll(wait, milliseconds(500)), 1);
  EXPECT_EQ(wait[0].revents, POLLIN);
  EXPECT_GE(kernel.now(), timer.ready_);
  EXPECT_LT(kernel.now(), timer.ready_ + milliseconds(1));
}

TEST_F(FakeKernelTest, TheChosenCallFailsOnceOrForEver) {
  kernel.plug("/dev/timer", timer);
  kernel.inject({.call = 2, .error = EIO});
  EXPECT_GE(kernel.open("/dev/timer", 0), 0);
  EXPECT_EQ(kernel.open("/dev/timer", 0), -EIO);
  EXPECT_GE(kernel.open("/dev/timer", 0), 0);
  kernel.inject({.call = kernel.calls() + 1, .forever = true, .error = ENODEV});
  EXPECT_EQ(kernel.open("/dev/timer", 0), -ENODEV);
  EXPECT_EQ(kernel.open("/dev/timer", 0), -ENODEV);
}

TEST_F(FakeKernelTest, AShortReadMovesHalfAndALateCallTakesItsTime) {
  kernel.plug("/dev/timer", timer);
  const kernel::OwnedFd fd(kernel, kernel.open("/dev/timer", 0));
  std::array<std::byte, 8> bytes;
  kernel.inject({.call = 2, .kind = FaultPlan::Kind::Short});
  EXPECT_EQ(kernel.read(fd.get(), bytes), 4);
  const Time before = kernel.now();
  kernel.inject({.call = 3, .kind = FaultPlan::Kind::Late, .delay = milliseconds(70)});
  EXPECT_EQ(kernel.read(fd.get(), bytes), 8);
  EXPECT_GE(kernel.now() - before, milliseconds(70));
}

TEST_F(FakeKernelTest, WhatIsNotGivenBackIsKnown) {
  kernel.plug("/dev/timer", timer);
  {
    const kernel::OwnedFd fd(kernel, kernel.open("/dev/timer", 0));
    int error = 0;
    const kernel::Mapping mapping(kernel, fd.get(), 4, true, 0, error);
    EXPECT_TRUE(mapping.valid());
    EXPECT_EQ(kernel.openDescriptors(), 1u);
    EXPECT_EQ(kernel.mappings(), 1u);
  }
  EXPECT_EQ(kernel.openDescriptors(), 0u);
  EXPECT_EQ(kernel.mappings(), 0u);
  EXPECT_EQ(kernel.misuses(), 0u);
  EXPECT_EQ(kernel.close(7), -EBADF);
  EXPECT_EQ(kernel.misuses(), 1u);
}

TEST_F(FakeKernelTest, PathsAreListedAndLinksFollowed) {
  kernel.plug("/dev/video0", timer);
  kernel.link("/dev/v4l/by-path/card", "/dev/video0");
  std::vector<std::string> names;
  EXPECT_EQ(kernel.list("/dev", names), 0);
  EXPECT_EQ(names, (std::vector<std::string>{"v4l", "video0"}));
  EXPECT_GE(kernel.open("/dev/v4l/by-path/card", 0), 0);
  EXPECT_EQ(kernel.open("/dev/video1", 0), -ENOENT);
  EXPECT_EQ(kernel.list("/sys", names), -ENOENT);
}

}  // namespace
}  // namespace depthscope::fake
