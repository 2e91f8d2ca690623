#include "overlay/status_painter.hpp"

#include <gmock/gmock.h>

#include "tests/overlay/allocation_count.hpp"
#include "tests/overlay/overlay_scene.hpp"
#include "types/error.hpp"

namespace depthscope::overlay {
namespace {

TEST(StatusPainter, TheFaultPictureIsOpaqueDarkAndSaysWhy) {
  StatusPainter painter("");
  for (const auto& [w, h] : {std::pair{320, 240}, {641, 359}}) {
    Image a(w, h), b(w, h);
    painter.paintFault("no signal", a.bytes, w, h);
    painter.paintFault("no camera", b.bytes, w, h);
    EXPECT_NE(a.bytes, b.bytes);
    int bright = 0;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        ASSERT_EQ(a.at(x, y)[3], 255);
        bright += a.luminance(x, y) > 150;
      }
    EXPECT_GT(bright, 60);
    EXPECT_LT(bright, w * h / 20);
    EXPECT_LT(a.luminance(2, 2), 25);
  }
}

TEST(StatusPainter, AStalePictureCannotBeTakenForALiveOne) {
  StatusPainter painter("");
  const Image live = noise(320, 240);
  Image stale = live;
  painter.paintStale("no new picture", stale.bytes, 320, 240);
  EXPECT_EQ(stale.at(0, 0)[0], live.at(0, 0)[0] / 2);
  EXPECT_EQ(stale.at(319, 239)[2], live.at(319, 239)[2] / 2);
  EXPECT_EQ(stale.at(5, 5)[3], live.at(5, 5)[3]);
  int bright = 0;
  for (int y = 90; y < 150; ++y)
    for (int x = 60; x < 260; ++x) bright += stale.luminance(x, y) > 200;
  EXPECT_GT(bright, 100) << "the notice";
}

TEST(StatusPainter, TheMarkStaysWithinItsPlace) {
  StatusPainter painter("");
  const Image before = noise(320, 240);
  for (int m = 0; m < kMarks; ++m) {
    Image image = before;
    const auto mark = static_cast<Mark>(m);
    painter.paintMark(mark, "damaged", image.bytes, 320, 240);
    const PixelRect rect = painter.markRect(320, 240, mark, "damaged");
    int changed = 0;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) {
        const bool same = std::equal(image.at(x, y), image.at(x, y) + 4, before.at(x, y));
        const bool inside = x >= rect.x0 && x < rect.x1 && y >= rect.y0 && y < rect.y1;
        ASSERT_TRUE(same || inside) << x << " " << y;
        changed += !same;
      }
    EXPECT_GT(changed, 300);
  }
}

TEST(StatusPainter, AllocatesNothingOnceAllIsPrepared) {
#ifdef DEPTHSCOPE_SANITIZED
  GTEST_SKIP() << "the sanitizer owns the allocation functions";
#endif
  StatusPainter painter("");
  const std::string_view messages[] = {"no signal", "a text longer than any small string holds"};
  painter.prepare(320, 240, messages);
  Image image = noise(320, 240);
  const long before = allocationCount();
  for (std::string_view message : messages) {
    painter.paintFault(message, image.bytes, 320, 240);
    painter.paintStale(message, image.bytes, 320, 240);
  }
  for (int m = 0; m < kMarks; ++m)
    painter.paintMark(static_cast<Mark>(m), {}, image.bytes, 320, 240);
  EXPECT_EQ(allocationCount(), before);
}

TEST(StatusPainter, NamesAFontThatIsMissing) {
  EXPECT_THROW(StatusPainter("/nowhere/none.ttf"), InputError);
}

}  // namespace
}  // namespace depthscope::overlay
