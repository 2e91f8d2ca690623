#include "recon/color_gallery.hpp"

#include <algorithm>
#include <limits>

namespace depthscope::recon {

ColorGallery::ColorGallery(int pictures, const ColorReduction& size)
    : slots_(static_cast<std::size_t>(pictures)) {
  for (Slot& slot : slots_) slot.color.reset(size.width, size.height);
  by_time_.reserve(slots_.size());
}

void ColorGallery::add(std::int64_t frame, const Grid<Rgb>& color) {
  Slot& slot = claim(frame);
  slot.color = color;
  slot.frame = frame;
}

void ColorGallery::update(const std::vector<std::int64_t>& view_frames) {
  frames_ = view_frames;
  std::sort(frames_.begin(), frames_.end());
}

const Grid<Rgb>* ColorGallery::find(std::int64_t frame) const {
  const auto slot =
      std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) { return s.frame == frame; });
  return slot == slots_.end() ? nullptr : &slot->color;
}

/// What is newer than the last cloud may be in the next one.
bool ColorGallery::culled(std::int64_t frame) const {
  return !frames_.empty() && frame <= frames_.back() &&
         !std::binary_search(frames_.begin(), frames_.end(), frame);
}

ColorGallery::Slot& ColorGallery::claim(std::int64_t frame) {
  by_time_.clear();
  for (Slot& slot : slots_) {
    if (slot.frame < 0 || slot.frame == frame || culled(slot.frame)) return slot;
    by_time_.push_back(&slot);
  }
  std::sort(by_time_.begin(), by_time_.end(),
            [](const Slot* a, const Slot* b) { return a->frame < b->frame; });
  Slot* chosen = by_time_.front();
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (std::size_t i = 1; i + 1 < by_time_.size(); ++i) {
    const std::int64_t gap = by_time_[i + 1]->frame - by_time_[i - 1]->frame;
    if (gap >= least) continue;
    least = gap;
    chosen = by_time_[i];
  }
  return *chosen;
}

}  // namespace depthscope::recon
