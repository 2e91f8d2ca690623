#pragma once

namespace depthscope {

/// Depth of `AllocationScope`s open on this thread. An allocator hook, where a program links one,
/// counts the allocations made while it is above zero; without a hook this costs one increment.
inline thread_local int allocation_scope_depth = 0;

/// Marks a stretch of a real-time thread in which nothing may be allocated once warm (tracking,
/// mapping, the video loop), so that a hook can count what is.
class AllocationScope {
 public:
  AllocationScope() { ++allocation_scope_depth; }
  ~AllocationScope() { --allocation_scope_depth; }
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;
};

}  // namespace depthscope
