#include "recon/picture_inbox.hpp"

#include <gmock/gmock.h>

#include <thread>
#include <vector>

namespace depthscope::recon {
namespace {

TEST(PictureInbox, HandsPicturesOverReducedAndInOrder) {
  PictureInbox inbox(4, 4, 2);
  EXPECT_FALSE(inbox.waiting());
  std::vector<std::uint8_t> pixels = {10, 20, 0, 0,  //
                                      30, 40, 0, 4,  //
                                      8,  8,  1, 1,  //
                                      8,  8,  1, 2};
  const GrayView view{pixels.data(), 4, 4, 4};
  const std::vector<Rgb> rgb(16, Rgb{1, 2, 3});  // so small a picture is not reduced
  const RgbView color{rgb.data(), 4, 4};
  ASSERT_TRUE(inbox.put(view, color, 7));
  ASSERT_TRUE(inbox.put(view, color, 9));
  ASSERT_TRUE(inbox.waiting());
  EXPECT_EQ(inbox.front().frame, 7);
  EXPECT_EQ(inbox.front().luma.cells, (std::vector<std::uint8_t>{25, 1, 8, 1}));
  EXPECT_EQ(inbox.front().color.cells, rgb);
  inbox.pop();
  EXPECT_EQ(inbox.front().frame, 9);
  inbox.pop();
  EXPECT_FALSE(inbox.waiting());
}

TEST(PictureInbox, KeepsNoLumaWhereNoneIsNeeded) {
  PictureInbox inbox(4, 4, 0);
  const std::vector<std::uint8_t> pixels(16, 5);
  const std::vector<Rgb> rgb(16, Rgb{1, 2, 3});
  ASSERT_TRUE(inbox.put({pixels.data(), 4, 4, 4}, {rgb.data(), 4, 4}, 1));
  EXPECT_EQ(inbox.front().luma.size(), 0u);
  EXPECT_EQ(inbox.front().color.cells, rgb);
}

TEST(PictureInbox, LeavesOutWhatDoesNotFit) {
  PictureInbox inbox(2, 2, 1);
  std::vector<std::uint8_t> pixels(4, 1);
  const GrayView view{pixels.data(), 2, 2, 2};
  std::int64_t taken = 0;
  while (inbox.put(view, {}, taken)) ++taken;
  EXPECT_GE(taken, 16);
  inbox.pop();
  EXPECT_TRUE(inbox.put(view, {}, 99));
  EXPECT_EQ(inbox.front().frame, 1);
}

TEST(PictureInbox, TwoThreadsNeverSeeHalfAPicture) {
  PictureInbox inbox(64, 64, 1);
  constexpr int kPictures = 2000;
  std::jthread writer([&] {
    std::vector<std::uint8_t> pixels(64 * 64);
    for (int i = 0; i < kPictures; ++i) {
      std::fill(pixels.begin(), pixels.end(), static_cast<std::uint8_t>(i));
      while (!inbox.put({pixels.data(), 64, 64, 64}, {}, i)) std::this_thread::yield();
    }
  });
  for (int i = 0; i < kPictures; ++i) {
    while (!inbox.waiting()) std::this_thread::yield();
    ASSERT_EQ(inbox.front().frame, i);
    for (std::uint8_t pixel : inbox.front().luma.cells)
      ASSERT_EQ(pixel, static_cast<std::uint8_t>(i));
    inbox.pop();
  }
}

}  // namespace
}  // namespace depthscope::recon
