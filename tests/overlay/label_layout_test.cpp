#include "overlay/label_layout.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace depthscope::overlay {
namespace {

using Eigen::AlignedBox2f;
using Eigen::Vector2f;

const AlignedBox2f kPicture(Vector2f(0, 0), Vector2f(639, 479));

LabelItem item(float x, float y, float w = 90, float h = 18) {
  LabelItem i;
  i.anchor = {x, y};
  i.size = {w, h};
  return i;
}
AlignedBox2f boxOf(const LabelItem& i) {
  return {i.top_left, i.top_left + i.size};
}

TEST(LabelLayout, KeepsTextsApartInsideThePictureAndOffTheObstacles) {
  std::vector<LabelItem> items;
  for (int i = 0; i < 12; ++i)
    items.push_back(
        item(300 + 9 * static_cast<float>(i % 4), 230 + 12 * static_cast<float>(i / 4)));
  items.push_back(item(2, 2));
  items.push_back(item(637, 477));
  const AlignedBox2f panel(Vector2f(330, 100), Vector2f(500, 220));
  placeLabels(items, kPicture, std::span(&panel, 1));
  int placed = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].slot < 0) continue;
    ++placed;
    EXPECT_TRUE(kPicture.contains(boxOf(items[i]))) << i;
    EXPECT_TRUE(boxOf(items[i]).intersection(panel).isEmpty()) << i;
    for (std::size_t j = 0; j < items.size(); ++j) {
      EXPECT_FALSE(boxOf(items[i]).contains(items[j].anchor)) << i << " " << j;
      if (j == i || items[j].slot < 0) continue;
      EXPECT_TRUE(boxOf(items[i]).intersection(boxOf(items[j])).isEmpty()) << i << " " << j;
    }
  }
  EXPECT_GE(placed, 8);
  EXPECT_GE(items[12].slot, 0);
  EXPECT_GE(items[13].slot, 0);
}

TEST(LabelLayout, ATextStaysWhereItWasThoughABetterPlaceIsFree) {
  std::vector<LabelItem> items{item(300, 200)};
  items[0].slot = 3;
  placeLabels(items, kPicture, {});
  EXPECT_EQ(items[0].slot, 3);
  const Vector2f offset = items[0].top_left - items[0].anchor;
  items[0].anchor += Vector2f(7.25f, -3.5f);
  placeLabels(items, kPicture, {});
  EXPECT_NEAR((items[0].top_left - items[0].anchor - offset).norm(), 0, 1e-3);
}

TEST(LabelLayout, GivesNoPlaceWhereThereIsNoRoom) {
  std::vector<LabelItem> items{item(300, 200, 700, 18)};
  placeLabels(items, kPicture, {});
  EXPECT_EQ(items[0].slot, -1);
}

}  // namespace
}  // namespace depthscope::overlay
