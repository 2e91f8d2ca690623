// Stands in front of glibc's allocator to count what real-time code allocates, and what memory
// metered work holds. The program's own definitions of malloc and its kin take precedence over the
// C library's for every library it loads.
#include "platform/allocation_hook.hpp"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "types/allocation_scope.hpp"
#include "types/memory_meter.hpp"

#if defined(__GLIBC__) && !defined(DEPTHSCOPE_SANITIZED)

namespace {
std::atomic<std::uint64_t> counted_allocations{0};

inline void count() {
  if (depthscope::allocation_scope_depth > 0)
    counted_allocations.fetch_add(1, std::memory_order_relaxed);
}
inline void* meter(void* p) {
  if (depthscope::current_memory_meter != nullptr)
    depthscope::current_memory_meter->allocated(static_cast<std::int64_t>(::malloc_usable_size(p)));
  return p;
}
inline void release(void* p) {
  if (depthscope::current_memory_meter != nullptr)
    depthscope::current_memory_meter->freed(static_cast<std::int64_t>(::malloc_usable_size(p)));
}
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t items, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* p);

void* malloc(std::size_t size) {
  count();
  return meter(__libc_malloc(size));
}
void* calloc(std::size_t items, std::size_t size) {
  count();
  return meter(__libc_calloc(items, size));
}
void* realloc(void* old, std::size_t size) {
  count();
  const std::size_t before = ::malloc_usable_size(old);
  void* p = __libc_realloc(old, size);
  if (depthscope::current_memory_meter != nullptr && (p != nullptr || size == 0))
    depthscope::current_memory_meter->freed(static_cast<std::int64_t>(before));
  return meter(p);
}
void free(void* p) {
  release(p);
  __libc_free(p);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count();
  return meter(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return meter(__libc_memalign(alignment, size));
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count();
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) return EINVAL;
  void* p = meter(__libc_memalign(alignment, size));
  if (p == nullptr) return ENOMEM;
  *out = p;
  return 0;
}
}  // extern "C"

namespace depthscope::platform {
std::optional<std::uint64_t> countedAllocations() {
  return counted_allocations.load(std::memory_order_relaxed);
}
}  // namespace depthscope::platform

#else

namespace depthscope::platform {
std::optional<std::uint64_t> countedAllocations() {
  return std::nullopt;
}
}  // namespace depthscope::platform

#endif
