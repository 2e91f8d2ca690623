#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "capture/frame.hpp"
#include "capture/pixel_convert.hpp"
#include "tests/capture/allocation_counter.hpp"

namespace depthscope::capture {
namespace {

TEST(Allocation, TheCounterCounts) {
  const int before = allocationCount();
  const auto pool = FramePool::create({PixelFormat::Gray8, 64, 48}, 2);
  EXPECT_GE(allocationCount() - before, 2);
}

TEST(Allocation, BorrowingConvertingAndReturningFramesAllocatesNothing) {
  const auto pool = FramePool::create({PixelFormat::Yuv420p, 64, 48}, 2);
  std::vector<std::uint8_t> rgba(64 * 48 * 4), gray(64 * 48);
  const int before = allocationCount();
  for (int i = 0; i < 100; ++i) {
    const Frame frame = pool->acquire();
    Frame other = pool->acquire();
    const Frame none = pool->acquire();
    other = Frame();
    toRgba(frame, rgba);
    toGray(frame, gray);
  }
  EXPECT_EQ(allocationCount(), before);
}

}  // namespace
}  // namespace depthscope::capture
