#pragma once
#include <cstddef>
#include <future>
#include <optional>
#include <system_error>
#include <vector>

#include "types/memory_meter.hpp"

namespace depthscope::recon {

/// Calls work(0) to work(n - 1), each in a thread of its own, the first in this one, and returns
/// when all are through. What they allocate counts on this thread's memory meter; an exception of
/// any is thrown here. Where the system has no thread to give, this one does more.
template <class Work>
void onThreads(int n, const Work& work) {
  MemoryMeter* const meter = current_memory_meter;
  std::vector<std::future<void>> others;
  int next = 1;
  try {
    for (; next < n; ++next)
      others.push_back(std::async(std::launch::async, [&work, meter, i = next] {
        std::optional<MemoryScope> metered;
        if (meter != nullptr) metered.emplace(*meter);
        work(i);
      }));
  } catch (const std::system_error&) {
  }
  work(0);
  for (; next < n; ++next) work(next);
  for (std::future<void>& other : others) other.get();
}

/// Calls work(begin, end) for `threads` ranges that together are 0 to n - 1, as onThreads does.
template <class Work>
void onRanges(int threads, std::size_t n, const Work& work) {
  const auto parts = static_cast<std::size_t>(threads);
  onThreads(threads, [&](int thread) {
    const auto i = static_cast<std::size_t>(thread);
    work(n * i / parts, n * (i + 1) / parts);
  });
}

}  // namespace depthscope::recon
