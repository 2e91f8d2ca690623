#pragma once
#include <atomic>
#include <cstdint>

namespace depthscope::kernel {

/// Tells another process that something is new: a word of memory that both share (futex(2)).
/// Whoever rings neither waits nor allocates, whatever the other side does to the word: unlike a
/// descriptor that two processes share, it has no state by which one could hold the other up.
/// Waiting, always with a limit, is SystemCalls::waitForRing().
class Bell {
 public:
  /// Wakes one who waits.
  void ring();
  /// How often it was rung, modulo 2^32. Read before looking at what is new, handed to the wait
  /// afterwards: then no ring is missed.
  std::uint32_t rings() const { return rings_.load(std::memory_order_acquire); }
  /// For the futex call.
  const std::atomic<std::uint32_t>& word() const { return rings_; }

 private:
  std::atomic<std::uint32_t> rings_{0};
  static_assert(sizeof(rings_) == 4 && std::atomic<std::uint32_t>::is_always_lock_free,
                "the kernel takes it for a plain word of 32 bits");
};

}  // namespace depthscope::kernel
