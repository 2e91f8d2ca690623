#include "recon/color_gallery.hpp"

#include <gmock/gmock.h>

namespace depthscope::recon {
namespace {

using ::testing::ElementsAre;

Grid<Rgb> plain(int value) {
  return Grid<Rgb>(4, 3, Rgb{static_cast<std::uint8_t>(value), 0, 0});
}

/// The frames that a gallery has pictures of, out of 0..99, each picture its own.
std::vector<std::int64_t> kept(const ColorGallery& gallery) {
  std::vector<std::int64_t> frames;
  for (int f = 0; f < 100; ++f)
    if (const Grid<Rgb>* color = gallery.find(f)) {
      EXPECT_EQ(color->cells, plain(f).cells);
      frames.push_back(f);
    }
  return frames;
}

TEST(ColorGallery, KeepsPicturesByTheirFrame) {
  ColorGallery gallery(4, ColorReduction(4, 3));
  EXPECT_EQ(gallery.find(0), nullptr);
  for (int f : {3, 8, 1}) gallery.add(f, plain(f));
  gallery.add(8, plain(8));
  EXPECT_THAT(kept(gallery), ElementsAre(1, 3, 8));
}

TEST(ColorGallery, WhatTheMapNoLongerHasGoesFirst) {
  ColorGallery gallery(4, ColorReduction(4, 3));
  for (int f : {0, 10, 20, 30}) gallery.add(f, plain(f));
  gallery.update({20, 0});  // 10 was culled; 30 is too new to be known
  gallery.add(40, plain(40));
  EXPECT_THAT(kept(gallery), ElementsAre(0, 20, 30, 40));
}

TEST(ColorGallery, StaysSpreadOverTime) {
  ColorGallery gallery(5, ColorReduction(4, 3));
  for (int f = 0; f < 60; ++f) gallery.add(f, plain(f));
  const std::vector<std::int64_t> frames = kept(gallery);
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_EQ(frames.front(), 0);
  EXPECT_EQ(frames.back(), 59);
  int covered = 0;  // halves of the time that have a picture besides the ends
  for (std::size_t i = 1; i + 1 < frames.size(); ++i) covered |= frames[i] < 30 ? 1 : 2;
  EXPECT_EQ(covered, 3);
}

}  // namespace
}  // namespace depthscope::recon
