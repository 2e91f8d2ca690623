#pragma once
#include <cstdint>
#include <optional>

namespace depthscope::platform {

/// Allocations made so far inside an AllocationScope, by any thread of a program that this is
/// linked into: calls of malloc, calloc, realloc and the aligned kinds, operator new included.
/// Nothing under sanitizers, which bring allocators of their own, and where the C library is not
/// glibc.
std::optional<std::uint64_t> countedAllocations();

}  // namespace depthscope::platform
