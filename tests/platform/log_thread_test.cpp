#include "platform/log_thread.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <thread>
#include <vector>

#include "platform/log.hpp"
#include "platform/unique_fd.hpp"

namespace depthscope::platform {
namespace {

using testing::HasSubstr;

TEST(LogQueue, HandsOutInOrderAndCountsWhatFindsNoRoom) {
  LogQueue queue;
  for (int i = 0; i < 100; ++i) queue.put({std::to_string(i), {}});
  queue.close();
  std::vector<std::string> lines;
  for (LogEntry entry; queue.take(entry);) lines.push_back(entry.line);
  ASSERT_EQ(lines.size(), 64u);
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i], std::to_string(i));
  EXPECT_EQ(queue.takeLost(), 36u);
  EXPECT_EQ(queue.takeLost(), 0u) << "told once";
}

TEST(LogQueue, LosesNothingUncountedBetweenThreads) {
  LogQueue queue;
  constexpr int threads = 4, lines_each = 2000;
  std::vector<std::thread> writers;
  std::uint64_t taken = 0;
  std::thread reader([&] {
    for (LogEntry entry; queue.take(entry); ++taken) EXPECT_EQ(entry.line, "a line");
  });
  for (int t = 0; t < threads; ++t)
    writers.emplace_back([&] {
      for (int i = 0; i < lines_each; ++i) queue.put({"a line", {}});
    });
  for (std::thread& writer : writers) writer.join();
  queue.close();
  reader.join();
  EXPECT_EQ(taken + queue.takeLost(), static_cast<std::uint64_t>(threads * lines_each));
}

/// Stderr is a pipe that nobody reads from, and full.
class FullStderr : public testing::Test {
 protected:
  void SetUp() override {
    int ends[2];
    ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    read_end = UniqueFd(ends[0]);
    const UniqueFd write_end(ends[1]);
    ASSERT_EQ(::fcntl(write_end.get(), F_SETFL, O_NONBLOCK), 0);
    const std::array<char, 4096> filler{};
    while (::write(write_end.get(), filler.data(), filler.size()) > 0) ++filled;
    ASSERT_EQ(::fcntl(write_end.get(), F_SETFL, 0), 0);
    before = UniqueFd(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 10));
    ASSERT_EQ(::dup2(write_end.get(), STDERR_FILENO), STDERR_FILENO);
  }
  void TearDown() override { ::dup2(before.get(), STDERR_FILENO); }
  void drain() {
    std::array<char, 4096> filler;
    for (; filled > 0; --filled) ASSERT_EQ(::read(read_end.get(), filler.data(), 4096), 4096);
  }
  /// All that was written until the last descriptor of the other end is closed.
  std::string rest() {
    ::dup2(before.get(), STDERR_FILENO);
    std::string text;
    std::array<char, 4096> part;
    for (ssize_t got; (got = ::read(read_end.get(), part.data(), part.size())) > 0;)
      text.append(part.data(), static_cast<std::size_t>(got));
    return text;
  }

  UniqueFd read_end, before;
  int filled = 0;
};

TEST_F(FullStderr, HoldsNobodyUpAndWhatIsMissingIsSaid) {
  {
    const LogThread thread;
    for (int i = 0; i < 500; ++i) log(LogPriority::Info, "news", {{"number", i}});
    // Here without having waited; now somebody reads.
    drain();
  }
  const std::string text = rest();
  EXPECT_THAT(text, HasSubstr("news number=0\n"));
  EXPECT_THAT(text, HasSubstr("log lines are missing here, nobody took them lines="));
}

TEST_F(FullStderr, DoesNotHoldTheEndUp) {
  {
    const LogThread thread;
    log(LogPriority::Info, "nobody will ever read this");
  }
  drain();  // lets the thread go that was left behind
  EXPECT_EQ(rest(), "nobody will ever read this\n");
}

}  // namespace
}  // namespace depthscope::platform
