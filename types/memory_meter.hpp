#pragma once
#include <atomic>
#include <cstdint>

namespace depthscope {

/// Bytes of the heap that one piece of work holds, and the most it ever held: what was allocated
/// within its `MemoryScope`s less what was freed there. Stays zero in a program without the
/// allocator hook. Several threads may count on one.
struct MemoryMeter {
  std::atomic<std::int64_t> held_bytes = 0;
  std::atomic<std::int64_t> peak_bytes = 0;

  void allocated(std::int64_t bytes) {
    const std::int64_t held = held_bytes.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    std::int64_t peak = peak_bytes.load(std::memory_order_relaxed);
    while (peak < held &&
           !peak_bytes.compare_exchange_weak(peak, held, std::memory_order_relaxed)) {
    }
  }
  void freed(std::int64_t bytes) { held_bytes.fetch_sub(bytes, std::memory_order_relaxed); }
};

/// The meter of this thread's innermost `MemoryScope`, or null.
inline thread_local MemoryMeter* current_memory_meter = nullptr;

/// While it lives, what this thread allocates and frees counts on `meter`.
class MemoryScope {
 public:
  explicit MemoryScope(MemoryMeter& meter) : outer_(current_memory_meter) {
    current_memory_meter = &meter;
    fence();
  }
  ~MemoryScope() {
    fence();
    current_memory_meter = outer_;
  }
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;

 private:
  /// Compilers take it that malloc and free look at no variable of the program: not these.
  static void fence() { std::atomic_signal_fence(std::memory_order_seq_cst); }

  MemoryMeter* outer_;
};

}  // namespace depthscope
