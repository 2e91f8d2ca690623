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
  for (int i = 0; i < 400; ++i) frames.add(i, start + i * 33ms);
  EXPECT_EQ(frames.captured(399), start + 399 * 33ms);
  EXPECT_EQ(frames.captured(150), start + 150 * 33ms);
  EXPECT_FALSE(frames.captured(140));
  EXPECT_FALSE(frames.captured(400));
  EXPECT_FALSE(frames.captured(-1));
  EXPECT_FALSE(frames.captured(std::numeric_limits<std::int64_t>::max()));
}

}  // namespace
}  // namespace depthscope::platform
