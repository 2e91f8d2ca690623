#include "overlay/label_pass.hpp"

#include <algorithm>
#include <cmath>

#include "overlay/lens.hpp"

namespace depthscope::overlay {
namespace {

using Eigen::AlignedBox2f;
using Eigen::Vector2f;

constexpr Color kBright{0.98f, 0.98f, 0.94f, 1};
constexpr Color kDark{0.03f, 0.03f, 0.05f, 0.65f};
constexpr double kTextFade_s = 0.2;  // of a text that changes its place, from one to the other
constexpr float kDot_px = 3.2f;      // radius, in pictures of 480 lines

}  // namespace

LabelPass::LabelPass(const CameraModel& camera, int capacity)
    : camera_(camera),
      max_radius_(validRadius(camera)),
      capacity_(static_cast<std::size_t>(capacity)) {
  labels_.reserve(capacity_);
  placements_.reserve(capacity_);
  items_.reserve(capacity_);
  depths_.reserve(capacity_);
  item_label_.reserve(capacity_);
}

void LabelPass::set(std::span<const Label> labels) {
  const std::size_t n = std::min(labels.size(), capacity_);
  std::vector<Placement> placements(n);  // a label that was there before keeps its place
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < labels_.size(); ++j)
      if (labels_[j].id == labels[i].id) placements[i] = placements_[j];
  placements_ = std::move(placements);
  labels_.assign(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(n));
}

void LabelPass::draw(const Pose& T_camera_world, std::uint32_t map_id, double time_s,
                     const TextAtlas& atlas, std::span<const AlignedBox2f> obstacles, Ink& ink) {
  items_.clear();
  depths_.clear();
  item_label_.clear();
  const Vector2f last(static_cast<float>(camera_.width - 1),
                      static_cast<float>(camera_.height - 1));
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    if (labels_[i].map_id != map_id || !labels_[i].anchor.allFinite()) continue;
    const Eigen::Vector3d p = T_camera_world * labels_[i].anchor.cast<double>();
    if (p.z() <= 0 || p.head<2>().norm() > max_radius_ * p.z()) continue;
    const Vector2f px = camera_.project(p).cast<float>();
    if (!AlignedBox2f(Vector2f::Zero(), last).contains(px)) continue;
    const TextSpot& spot = atlas.spot(static_cast<int>(i));
    LabelItem& item = items_.emplace_back();
    item.anchor = px;
    item.size = {static_cast<float>(spot.width), static_cast<float>(spot.height)};
    item.slot = placements_[i].slot;
    depths_.push_back(static_cast<float>(p.z()));
    item_label_.push_back(i);
  }
  const Vector2f margin = 0.012f * last.y() * Vector2f::Ones();
  placeLabels(items_, {margin, last - margin}, obstacles);

  for (std::size_t k = 0; k < items_.size(); ++k) {
    const std::size_t i = item_label_[k];
    const LabelItem& item = items_[k];
    Placement& placement = placements_[i];
    if (item.slot != placement.slot) {
      const bool had_place = placement.slot >= 0;
      placement.slot_before = placement.slot;
      placement.offset_before = placement.offset;
      placement.slot = item.slot;
      placement.since_s = had_place ? time_s : -1;
    }
    placement.offset = item.top_left - item.anchor;
    const bool fading = time_s >= 0 && placement.since_s >= 0 && time_s >= placement.since_s;
    const auto shown =
        static_cast<float>(fading ? std::min((time_s - placement.since_s) / kTextFade_s, 1.0) : 1);
    const TextSpot& spot = atlas.spot(static_cast<int>(i));
    if (placement.slot_before >= 0)
      drawText(item, item.anchor + placement.offset_before, depths_[k], spot, 1 - shown, ink);
    if (placement.slot >= 0) drawText(item, item.top_left, depths_[k], spot, shown, ink);
    drawDot(item.anchor, depths_[k], ink);
  }
}

float LabelPass::unit() const {
  return std::max(1.0f, static_cast<float>(camera_.height) / 480.0f);
}

void LabelPass::drawText(const LabelItem& item, const Vector2f& top_left, float depth,
                         const TextSpot& spot, float alpha, Ink& ink) const {
  if (!(alpha > 0)) return;
  const Anchor anchor{item.anchor, depth, Anchor::WhenHidden::Dimmed};
  const Vector2f low = top_left, high = top_left + item.size;
  const Vector2f end =
      item.anchor.cwiseMax(low + 0.12f * item.size).cwiseMin(high - 0.12f * item.size);
  const Vector2f along = end - item.anchor;
  const Vector2f start =
      item.anchor + along * std::min(1.0f, 1.4f * kDot_px * unit() / std::max(along.norm(), 1e-3f));
  // The leader ends where the text's box begins.
  const Vector2f inside = (end - low).cwiseMin(high - end);
  const Vector2f stop = end - along.normalized() * std::min(inside.minCoeff() * 0.4f, along.norm());
  ink.line(start, stop, 3.2f * unit(), kDark.withAlpha(kDark.a * alpha), anchor, 7 * unit());
  ink.line(start, stop, 1.4f * unit(), kBright.withAlpha(0.9f * alpha), anchor, 7 * unit());
  ink.text(top_left, spot, kBright.withAlpha(alpha), anchor);
}

void LabelPass::drawDot(const Vector2f& at, float depth, Ink& ink) const {
  using When = Anchor::WhenHidden;
  const Anchor shown{at, depth, When::Gone}, hidden = shown.but(When::OnlyThen);
  const float dot = kDot_px * unit();
  ink.disc(at, dot + 1.2f * unit(), kDark, shown);
  ink.disc(at, dot, kBright, shown);
  ink.ring(at, dot + 1.8f * unit(), 3.4f * unit(), kDark, hidden);
  ink.ring(at, dot + 0.8f * unit(), 1.4f * unit(), kBright.withAlpha(0.75f), hidden);
}

}  // namespace depthscope::overlay
