#include "overlay/label_layout.hpp"

#include <algorithm>

namespace depthscope::overlay {
namespace {

using Eigen::AlignedBox2f;
using Eigen::Vector2f;

// Above before below, for instruments come from below; slanted leaders read best.
constexpr float kDirections[8][2] = {{1, -1}, {-1, -1}, {1, 1}, {-1, 1},
                                     {0, -1}, {0, 1},   {1, 0}, {-1, 0}};
constexpr float kDistances[] = {0.9f, 2.0f, 3.4f};  // of the text's height
constexpr int kSlots = 24;
constexpr float kGap = 0.2f;  // between texts, of the text's height

AlignedBox2f boxInSlot(const LabelItem& item, int slot) {
  const float* d = kDirections[slot % 8];
  const float distance = kDistances[slot / 8] * item.size.y();
  const Vector2f centre = item.anchor + Vector2f(d[0] * (0.5f * item.size.x() + distance),
                                                 d[1] * (0.5f * item.size.y() + distance));
  return {centre - 0.5f * item.size, centre + 0.5f * item.size};
}

bool overlap(const AlignedBox2f& a, const AlignedBox2f& b) {
  return a.min().x() < b.max().x() && b.min().x() < a.max().x() && a.min().y() < b.max().y() &&
         b.min().y() < a.max().y();
}

}  // namespace

void placeLabels(std::span<LabelItem> items, const AlignedBox2f& picture,
                 std::span<const AlignedBox2f> obstacles) {
  const auto isFree = [&](std::size_t i, const AlignedBox2f& text) {
    if (!picture.contains(text)) return false;
    const Vector2f gap = Vector2f::Constant(kGap * items[i].size.y());
    const AlignedBox2f box(text.min() - gap, text.max() + gap);
    for (const AlignedBox2f& o : obstacles)
      if (overlap(box, o)) return false;
    for (std::size_t j = 0; j < items.size(); ++j) {
      if (j < i && items[j].slot >= 0 &&
          overlap(box, {items[j].top_left, items[j].top_left + items[j].size}))
        return false;
      const Vector2f dot = Vector2f::Constant(0.3f * items[j].size.y());
      if (overlap(box, {items[j].anchor - dot, items[j].anchor + dot})) return false;
    }
    return true;
  };
  for (std::size_t i = 0; i < items.size(); ++i) {
    LabelItem& item = items[i];
    const int before = item.slot;
    item.slot = -1;
    // -1 stands for the slot it had.
    for (int s = before >= 0 ? -1 : 0; s < kSlots; ++s) {
      const int slot = s < 0 ? before : s;
      const AlignedBox2f box = boxInSlot(item, slot);
      if (!isFree(i, box)) continue;
      item.slot = slot;
      item.top_left = box.min();
      break;
    }
  }
}

}  // namespace depthscope::overlay
