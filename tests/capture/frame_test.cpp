#include "capture/frame.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>
#include <vector>

#include "types/error.hpp"

namespace depthscope::capture {
namespace {

constexpr FrameFormat kYuv{PixelFormat::Yuv420p, 33, 17};

TEST(FramePool, GivesEachBufferToOneOwnerAndIsThenEmpty) {
  const auto pool = FramePool::create(kYuv, 3);
  const Frame a = pool->acquire(), b = pool->acquire(), c = pool->acquire();
  ASSERT_FALSE(a.empty() || b.empty() || c.empty());
  EXPECT_NE(a.planes[0].data, b.planes[0].data);
  EXPECT_NE(b.planes[0].data, c.planes[0].data);
  EXPECT_NE(a.planes[0].data, c.planes[0].data);
  EXPECT_TRUE(pool->acquire().empty());
}

TEST(FramePool, TakesABufferBackWhenItsFrameIsDestroyedOrOverwritten) {
  const auto pool = FramePool::create(kYuv, 1);
  { const Frame frame = pool->acquire(); }
  Frame frame = pool->acquire();
  ASSERT_FALSE(frame.empty());
  frame = Frame();
  EXPECT_FALSE(pool->acquire().empty());
}

TEST(FramePool, MovingAFrameKeepsItsBufferBorrowedOnce) {
  const auto pool = FramePool::create(kYuv, 1);
  Frame first = pool->acquire();
  first.sequence = 7;
  const std::uint8_t* data = first.planes[0].data;
  Frame second = std::move(first);
  EXPECT_TRUE(first.empty());  // NOLINT: what a moved-from frame is, is the point
  EXPECT_EQ(first.planes[0].data, nullptr);
  EXPECT_EQ(second.sequence, 7u);
  EXPECT_EQ(second.planes[0].data, data);
  EXPECT_TRUE(pool->acquire().empty());
  second = std::move(second);
  EXPECT_FALSE(second.empty());
}

TEST(FramePool, AFrameMayOutliveWhoeverMadeThePool) {
  Frame frame;
  {
    const auto pool = FramePool::create(kYuv, 2);
    frame = pool->acquire();
  }
  std::memset(frame.planes[0].data, 1, 33);
  EXPECT_EQ(frame.planes[0].data[32], 1);
}

TEST(FramePool, AlignsEveryRowOfEveryPlaneTo64Bytes) {
  for (int i = 0; i < kPixelFormats; ++i) {
    const auto format = static_cast<PixelFormat>(i);
    const auto pool = FramePool::create({format, 33, 17}, 2);
    const Frame frames[] = {pool->acquire(), pool->acquire()};
    for (const Frame& frame : frames)
      for (int plane = 0; plane < planeCount(format); ++plane) {
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(frame.planes[plane].data) % 64, 0u);
        EXPECT_EQ(frame.planes[plane].stride % 64, 0);
        EXPECT_GE(frame.planes[plane].stride, planeSize(frame.format, plane).row_bytes);
      }
  }
}

TEST(FramePool, PlanesDoNotOverlap) {
  const auto pool = FramePool::create(kYuv, 2);
  std::vector<Frame> frames;
  for (Frame frame = pool->acquire(); !frame.empty(); frame = pool->acquire())
    frames.push_back(std::move(frame));
  ASSERT_EQ(frames.size(), 2u);
  const auto forEachRow = [&](auto&& visit) {
    int value = 0;
    for (Frame& frame : frames)
      for (int plane = 0; plane < 3; ++plane, ++value)
        for (int y = 0; y < planeSize(kYuv, plane).rows; ++y)
          visit(frame.planes[plane].data + y * frame.planes[plane].stride,
                planeSize(kYuv, plane).row_bytes, value);
  };
  forEachRow([](std::uint8_t* row, int bytes, int value) { std::memset(row, value, bytes); });
  forEachRow([](std::uint8_t* row, int bytes, int value) {
    for (int x = 0; x < bytes; ++x) ASSERT_EQ(row[x], value);
  });
}

TEST(FramePool, RefusesSizesAndCountsOutOfRange) {
  EXPECT_THROW(FramePool::create({PixelFormat::Gray8, 0, 10}, 2), InputError);
  EXPECT_THROW(FramePool::create({PixelFormat::Gray8, 10, 16385}, 2), InputError);
  EXPECT_THROW(FramePool::create({PixelFormat::Gray8, 10, 10}, 0), InputError);
  EXPECT_THROW(FramePool::create({PixelFormat::Gray8, 10, 10}, 65), InputError);
  EXPECT_NO_THROW(FramePool::create({PixelFormat::Gray8, 10, 10}, 64));
}

TEST(FramePool, NeverGivesOneBufferToTwoThreads) {
  const auto pool = FramePool::create({PixelFormat::Gray8, 64, 1}, 3);
  std::atomic<int> clashes{0};
  const auto work = [&](std::uint8_t mark) {
    for (int i = 0; i < 5000; ++i) {
      const Frame frame = pool->acquire();
      if (frame.empty()) continue;
      std::memset(frame.planes[0].data, mark, 64);
      for (int x = 0; x < 64; ++x) clashes += frame.planes[0].data[x] != mark;
    }
  };
  std::vector<std::thread> threads;
  for (std::uint8_t mark = 1; mark <= 4; ++mark) threads.emplace_back(work, mark);
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(clashes, 0);
  const Frame a = pool->acquire(), b = pool->acquire(), c = pool->acquire();
  EXPECT_FALSE(a.empty() || b.empty() || c.empty()) << "a buffer was lost";
}

TEST(Frame, LumaIsThePlaneItselfWhereThereIsOne) {
  for (const PixelFormat format : {PixelFormat::Gray8, PixelFormat::Yuv420p, PixelFormat::Yuv422p,
                                   PixelFormat::Yuv444p, PixelFormat::Nv12, PixelFormat::Nv16}) {
    const Frame frame = FramePool::create({format, 33, 17}, 1)->acquire();
    EXPECT_EQ(frame.luma().data, frame.planes[0].data);
    EXPECT_EQ(frame.luma().stride, frame.planes[0].stride);
    EXPECT_EQ(frame.luma().width, 33);
    EXPECT_EQ(frame.luma().height, 17);
  }
  for (const PixelFormat format : {PixelFormat::Rgb24, PixelFormat::Bgr24, PixelFormat::Rgba32,
                                   PixelFormat::Bgrx32, PixelFormat::Yuyv, PixelFormat::Uyvy})
    EXPECT_TRUE(FramePool::create({format, 33, 17}, 1)->acquire().luma().empty());
  EXPECT_TRUE(Frame().luma().empty());
}

TEST(PlaneSize, RoundsChromaOfOddPicturesUp) {
  EXPECT_EQ(planeSize(kYuv, 2).row_bytes, 17);
  EXPECT_EQ(planeSize(kYuv, 2).rows, 9);
  EXPECT_EQ(planeSize({PixelFormat::Nv12, 33, 17}, 1).row_bytes, 34);
  EXPECT_EQ(planeSize({PixelFormat::Nv16, 33, 17}, 1).rows, 17);
  EXPECT_EQ(planeSize({PixelFormat::Yuyv, 33, 17}, 0).row_bytes, 68);
}

}  // namespace
}  // namespace depthscope::capture
