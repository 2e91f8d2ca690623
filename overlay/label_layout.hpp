#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

namespace depthscope::overlay {

/// A text to be placed next to its anchor.
struct LabelItem {
  Eigen::Vector2f anchor;                          // [px]
  Eigen::Vector2f size = Eigen::Vector2f::Zero();  // [px]
  int slot = -1;  // in: where it was placed before, or -1; out: where it is now, -1: no room
  Eigen::Vector2f top_left = Eigen::Vector2f::Zero();  // out, when placed [px]
};

/// Places texts around their anchors so that they lie within `picture` and overlap neither each
/// other, nor `obstacles`, nor any anchor. Earlier items choose first; an item keeps its slot while
/// it can, so that texts stay with their anchors instead of hopping around them. Items without room
/// get no text (slot -1).
void placeLabels(std::span<LabelItem> items, const Eigen::AlignedBox2f& picture,
                 std::span<const Eigen::AlignedBox2f> obstacles);

}  // namespace depthscope::overlay
