#include "tests/slam/allocation_counter.hpp"

#include <cstddef>
#include <utility>

#include "types/allocation_scope.hpp"

namespace {
thread_local std::int64_t allocation_count = 0;
}

#ifndef DEPTHSCOPE_SANITIZED
extern "C" {
void* __libc_malloc(std::size_t size);

void* malloc(std::size_t size) {
  if (depthscope::allocation_scope_depth > 0) ++allocation_count;
  return __libc_malloc(size);
}
}
#endif

namespace depthscope::slam::testing {

std::int64_t takeAllocationCount() {
  return std::exchange(allocation_count, 0);
}

}  // namespace depthscope::slam::testing
