// Counts every call of operator new in this program.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include "capture/frame.hpp"
#include "capture/pixel_convert.hpp"

namespace {
std::atomic<int> allocations{0};
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto a = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(a, (size + a - 1) / a * a)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace depthscope::capture {
namespace {

TEST(Allocation, TheCounterCounts) {
  const int before = allocations;
  const std::vector<int> vector(10);
  EXPECT_GT(allocations, before);
}

TEST(Allocation, BorrowingConvertingAndReturningFramesAllocatesNothing) {
  const auto pool = FramePool::create({PixelFormat::Yuv420p, 64, 48}, 2);
  std::vector<std::uint8_t> rgba(64 * 48 * 4), gray(64 * 48);
  const int before = allocations;
  for (int i = 0; i < 100; ++i) {
    const Frame frame = pool->acquire();
    Frame other = pool->acquire();
    const Frame none = pool->acquire();
    other = Frame();
    toRgba(frame, rgba);
    toGray(frame, gray);
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace depthscope::capture
