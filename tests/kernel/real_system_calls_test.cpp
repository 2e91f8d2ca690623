#include <fcntl.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "kernel/mapping.hpp"
#include "kernel/owned_fd.hpp"

namespace depthscope::kernel {
namespace {

class RealSystemCallsTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "callsXXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder = pattern;
    std::ofstream(folder / "b") << "abcdefgh";
    std::ofstream(folder / "a") << "";
    std::filesystem::create_symlink("b", folder / "c");
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  SystemCalls& calls = realSystemCalls();
  std::filesystem::path folder;
};

TEST_F(RealSystemCallsTest, ErrorsComeAsNegativeErrno) {
  int error = 0;
  EXPECT_EQ(calls.open((folder / "none").c_str(), O_RDONLY), -ENOENT);
  EXPECT_EQ(calls.close(-1), -EBADF);
  EXPECT_EQ(calls.mmap(-1, 4096, false, 0, error), nullptr);
  EXPECT_EQ(error, -EBADF);
  std::array<std::byte, 1> byte;
  EXPECT_EQ(calls.read(-1, byte), -EBADF);
  EXPECT_EQ(calls.ioctl(-1, 0, nullptr), -EBADF);
}

TEST_F(RealSystemCallsTest, AFileIsReadAndMapped) {
  const OwnedFd fd(calls, calls.open((folder / "b").c_str(), O_RDONLY));
  ASSERT_TRUE(fd.valid());
  std::array<std::byte, 3> bytes;
  EXPECT_EQ(calls.read(fd.get(), bytes), 3);
  EXPECT_EQ(bytes[2], std::byte('c'));
  int error = 0;
  const Mapping mapping(calls, fd.get(), 8, false, 0, error);
  ASSERT_TRUE(mapping.valid());
  EXPECT_EQ(mapping.bytes()[7], std::byte('h'));
}

TEST_F(RealSystemCallsTest, DirectoriesAndLinksAreRead) {
  std::vector<std::string> names;
  EXPECT_EQ(calls.list(folder.c_str(), names), 0);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "b", "c"}));
  std::string target;
  EXPECT_EQ(calls.readLink((folder / "c").c_str(), target), 0);
  EXPECT_EQ(target, "b");
  EXPECT_EQ(calls.readLink((folder / "a").c_str(), target), -EINVAL);
}

TEST_F(RealSystemCallsTest, PollGivesUpAfterItsTimeout) {
  const auto before = calls.now();
  EXPECT_EQ(calls.poll({}, std::chrono::milliseconds(5)), 0);
  EXPECT_GE(calls.now() - before, std::chrono::milliseconds(5));
}

TEST(RetryInterrupted, TriesAgainButNotForEver) {
  int made = 0;
  EXPECT_EQ(retryInterrupted([&] { return ++made < 3 ? -EINTR : 7; }), 7);
  made = 0;
  EXPECT_EQ(retryInterrupted([&] {
              ++made;
              return -EINTR;
            }),
            -EINTR);
  EXPECT_EQ(made, 8);
}

}  // namespace
}  // namespace depthscope::kernel
