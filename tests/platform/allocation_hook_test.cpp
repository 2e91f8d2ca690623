#include "platform/allocation_hook.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "types/allocation_scope.hpp"
#include "types/memory_meter.hpp"

namespace depthscope::platform {
namespace {

class AllocationHook : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!countedAllocations()) GTEST_SKIP() << "sanitizers bring allocators of their own";
  }
  template <class F>
  std::uint64_t counted(F&& f) {
    const std::uint64_t before = *countedAllocations();
    f();
    return *countedAllocations() - before;
  }
};

/// Keeps the optimizer from taking an allocation out.
void touch(void* p) {
  asm volatile("" : : "g"(p) : "memory");
}

TEST_F(AllocationHook, CountsEachKindInsideAScope) {
  EXPECT_EQ(counted([] {
              const AllocationScope scope;
              std::unique_ptr<int> a(new int(1));
              touch(a.get());
              void* b = std::malloc(10);
              touch(b);
              b = std::realloc(b, 100000);
              touch(b);
              void* c = std::calloc(3, 5);
              touch(c);
              void* d = std::aligned_alloc(64, 128);
              touch(d);
              void* e = nullptr;
              EXPECT_EQ(posix_memalign(&e, 64, 128), 0);
              EXPECT_EQ(reinterpret_cast<std::uintptr_t>(e) % 64, 0u);
              for (void* p : {b, c, d, e}) std::free(p);
            }),
            6u);
}

TEST_F(AllocationHook, CountsNothingOutside) {
  EXPECT_EQ(counted([] {
              std::vector<int> v(1000);
              touch(v.data());
            }),
            0u);
}

TEST_F(AllocationHook, ScopesAreOfOneThread) {
  EXPECT_EQ(counted([] {
              std::thread other;
              { const AllocationScope scope; }
              other = std::thread([] {
                std::vector<int> v(1000);
                touch(v.data());
              });
              other.join();
            }),
            0u);
}

TEST_F(AllocationHook, MetersWhatWorkHoldsAndItsPeak) {
  MemoryMeter meter;
  void* kept = nullptr;
  {
    const MemoryScope scope(meter);
    kept = std::malloc(1000);
    touch(kept);
    std::vector<char> passing(100000);
    touch(passing.data());
    kept = std::realloc(kept, 5000);
    touch(kept);
  }
  EXPECT_GE(meter.held_bytes, 5000);
  EXPECT_LT(meter.held_bytes, 6000);
  EXPECT_GE(meter.peak_bytes, 105000);
  EXPECT_LT(meter.peak_bytes, 110000);
  std::vector<char> outside(100000);
  touch(outside.data());
  {
    const MemoryScope scope(meter);
    std::free(kept);
  }
  EXPECT_EQ(meter.held_bytes, 0);
}

}  // namespace
}  // namespace depthscope::platform
