#include "platform/daemon/published_frames.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace depthscope::platform {
namespace {

using namespace std::chrono_literals;

TEST(PublishedFrames, RemembersTheLastOnesOnly) {
  PublishedFrames frames;
  const PublishedFrames::Time start{};
  EXPECT_FALSE(frames.captured(0));
  for (int i = 0; i < 100; ++i) frames.add(i, start + i * 33ms);
  EXPECT_EQ(frames.captured(99), start + 99 * 33ms);
  EXPECT_EQ(frames.captured(40), start + 40 * 33ms);
  EXPECT_FALSE(frames.captured(20));
  EXPECT_FALSE(frames.captured(100));
  EXPECT_FALSE(frames.captured(-1));
  EXPECT_FALSE(frames.captured(std::numeric_limits<std::int64_t>::max()));
}

}  // namespace
}  // namespace depthscope::platform
