#include "recon/threads.hpp"

#include <gtest/gtest.h>

#include <array>
#include <mutex>
#include <new>
#include <set>
#include <thread>

namespace depthscope::recon {
namespace {

TEST(OnThreads, CallsEachOnceAndFromThreadsOfTheirOwn) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  std::array<int, 4> calls{};
  onThreads(4, [&](int i) {
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
    ++calls[static_cast<std::size_t>(i)];
  });
  EXPECT_EQ(calls, (std::array<int, 4>{1, 1, 1, 1}));
  EXPECT_EQ(threads.size(), 4U);
  EXPECT_TRUE(threads.contains(std::this_thread::get_id()));
}

TEST(OnRanges, GoesThroughAllOnceOnAnyNumberOfThreads) {
  for (int threads : {1, 2, 3, 7}) {
    std::array<int, 5> calls{};
    onRanges(threads, calls.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++calls[i];
    });
    EXPECT_EQ(calls, (std::array<int, 5>{1, 1, 1, 1, 1})) << threads;
  }
}

TEST(OnThreads, ThrowsWhatAnyOfThemThrows) {
  for (int thrower : {0, 1})
    EXPECT_THROW(onThreads(2,
                           [&](int i) {
                             if (i == thrower) throw std::bad_alloc();
                           }),
                 std::bad_alloc);
}

TEST(OnThreads, CountsOnTheMeterOfTheThreadThatCalls) {
  MemoryMeter meter;
  const MemoryScope scope(meter);
  std::array<MemoryMeter*, 3> seen{};
  onThreads(3, [&](int i) { seen[static_cast<std::size_t>(i)] = current_memory_meter; });
  for (const MemoryMeter* m : seen) EXPECT_EQ(m, &meter);
}

}  // namespace
}  // namespace depthscope::recon
