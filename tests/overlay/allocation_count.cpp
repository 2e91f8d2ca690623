#include "tests/overlay/allocation_count.hpp"

#include <cstdlib>
#include <new>

namespace {
thread_local long allocations = 0;
}

namespace depthscope::overlay {
long allocationCount() {
  return allocations;
}
}  // namespace depthscope::overlay

// The sanitizers bring allocation functions of their own.
#ifndef DEPTHSCOPE_SANITIZED
void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
#endif
