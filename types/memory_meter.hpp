#pragma once
#include <algorithm>
#include <cstdint>

namespace depthscope {

/// Bytes of the heap that one piece of work holds, and the most it ever held: what was allocated
/// within its `MemoryScope`s less what was freed there. Stays zero in a program without the
/// allocator hook.
struct MemoryMeter {
  std::int64_t held_bytes = 0;
  std::int64_t peak_bytes = 0;

  void allocated(std::int64_t bytes) {
    held_bytes += bytes;
    peak_bytes = std::max(peak_bytes, held_bytes);
  }
  void freed(std::int64_t bytes) { held_bytes -= bytes; }
};

/// The meter of this thread's innermost `MemoryScope`, or null.
inline thread_local MemoryMeter* current_memory_meter = nullptr;

/// While it lives, what this thread allocates and frees counts on `meter`.
class MemoryScope {
 public:
  explicit MemoryScope(MemoryMeter& meter) : outer_(current_memory_meter) {
    current_memory_meter = &meter;
  }
  ~MemoryScope() { current_memory_meter = outer_; }
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;

 private:
  MemoryMeter* outer_;
};

}  // namespace depthscope
