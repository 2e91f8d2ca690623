#pragma once
#include <span>
#include <vector>

#include "overlay/ink.hpp"
#include "overlay/label_layout.hpp"
#include "types/camera_model.hpp"
#include "types/label.hpp"
#include "types/pose.hpp"

namespace depthscope::overlay {

/// The labels over the picture: a dot on the tissue, a leader, the text.
///
/// What a label marks may lie behind tissue that is nearer. It stays readable, for a vessel does
/// not cease to matter when a fold hides it, but must not look as if it lay on that fold: dot
/// becomes ring, leader dashed, all of it dimmer.
class LabelPass {
 public:
  LabelPass(const CameraModel& camera, int capacity);

  void set(std::span<const Label> labels);
  std::span<const Label> labels() const { return labels_; }

  /// Lays out the labels of map `map_id` and adds them to `ink`; `atlas` holds text i in slot i.
  /// `time_s` < 0: unknown, texts that move to another place then do so without a fade.
  void draw(const Pose& T_camera_world, std::uint32_t map_id, double time_s, const TextAtlas& atlas,
            std::span<const Eigen::AlignedBox2f> obstacles, Ink& ink);

 private:
  /// Where a label's text is, and was before: slots of placeLabels(), -1 for none, and the text's
  /// upper left corner from the anchor [px].
  struct Placement {
    int slot = -1, slot_before = -1;
    Eigen::Vector2f offset = Eigen::Vector2f::Zero(), offset_before = Eigen::Vector2f::Zero();
    double since_s = -1;  // it is in this slot
  };
  float unit() const;  // a pixel of a picture of 480 lines [px]
  void drawText(const LabelItem& item, const Eigen::Vector2f& top_left, float depth,
                const TextSpot& spot, float alpha, Ink& ink) const;
  void drawDot(const Eigen::Vector2f& at, float depth, Ink& ink) const;

  CameraModel camera_;
  double max_radius_;
  std::size_t capacity_;
  std::vector<Label> labels_;
  std::vector<Placement> placements_;  // of labels_
  std::vector<LabelItem> items_;       // of the labels in view
  std::vector<float> depths_;          // of items_
  std::vector<std::size_t> item_label_;
};

}  // namespace depthscope::overlay
