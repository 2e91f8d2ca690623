#pragma once
#include <cstdint>

namespace depthscope::slam::testing {

/// Calls of malloc (and so of operator new) made by this thread inside an AllocationScope since the
/// last call of this function. Always zero under a sanitizer, which brings its own allocator.
std::int64_t takeAllocationCount();

}  // namespace depthscope::slam::testing
