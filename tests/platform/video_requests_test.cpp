#include "platform/daemon/video_requests.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace depthscope::platform {
namespace {

TEST(VideoRequests, HandsOverlaySettingsOverOnce) {
  VideoRequests requests;
  EXPECT_FALSE(requests.takeOverlay());
  overlay::OverlaySettings settings;
  settings.opacity = 0.125f;
  requests.setOverlay(settings);
  const auto taken = requests.takeOverlay();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->opacity, 0.125f);
  EXPECT_FALSE(requests.takeOverlay());
}

TEST(VideoRequests, ASnapshotIsTheNextPictureOffered) {
  VideoRequests requests;
  requests.setPictureBytes(8);
  std::atomic<bool> done{false};
  std::thread video([&] {
    const std::uint8_t pixels[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    while (!done) requests.offerPicture({pixels, 2, 1, 8}, 7);
  });
  const auto snapshot = requests.snapshot();
  done = true;
  video.join();
  ASSERT_TRUE(snapshot);
  EXPECT_EQ(snapshot->frame, 7);
  EXPECT_EQ(snapshot->width, 2);
  EXPECT_EQ(snapshot->pixels, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8}));
}

}  // namespace
}  // namespace depthscope::platform
