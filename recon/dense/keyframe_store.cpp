#include "recon/dense/keyframe_store.hpp"

#include <algorithm>
#include <limits>

namespace depthscope::recon {

StoredKeyframe& KeyframeStore::claim(std::int64_t frame) {
  StoredKeyframe* chosen = &slots_.front();
  float least = std::numeric_limits<float>::max();
  for (StoredKeyframe& slot : slots_) {
    const float worth = slot.frame < 0 || slot.frame == frame ? -2 : worthOf(slot.frame);
    if (worth >= least) continue;
    least = worth;
    chosen = &slot;
  }
  dropDepth(*chosen);
  chosen->frame = -1;
  chosen->retired = false;
  return *chosen;
}

/// Culled keyframes are worth nothing, those that no cloud has told of yet everything.
float KeyframeStore::worthOf(std::int64_t frame) const {
  const auto known = std::lower_bound(worth_.begin(), worth_.end(), frame,
                                      [](const Worth& w, std::int64_t f) { return w.frame < f; });
  if (known != worth_.end() && known->frame == frame) return known->worth;
  return frame > last_cloud_frame_ ? std::numeric_limits<float>::max() / 2 : -1;
}

void KeyframeStore::update(const CloudIndex& index) {
  worth_.clear();
  last_cloud_frame_ = -1;
  const auto& frames = index.cloud().keyframe_frames;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    float worth = 0;  // points, each shared among those who see it
    for (std::uint32_t p : index.pointsOf(k))
      worth += 1 / static_cast<float>(index.sightingsOf(p).size());
    worth_.push_back({frames[k], worth});
    last_cloud_frame_ = std::max(last_cloud_frame_, frames[k]);
  }
  std::sort(worth_.begin(), worth_.end(),
            [](const Worth& a, const Worth& b) { return a.frame < b.frame; });
}

std::vector<StoredKeyframe*> KeyframeStore::inOrderOf(const SparseCloud& cloud) {
  std::vector<StoredKeyframe*> out;
  for (std::int64_t frame : cloud.keyframe_frames) {
    const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                   [&](const StoredKeyframe& s) { return s.frame == frame; });
    out.push_back(slot == slots_.end() ? nullptr : &*slot);
  }
  return out;
}

DepthMap& KeyframeStore::makeDepth(StoredKeyframe& keyframe, const CloudIndex& index,
                                   const std::vector<StoredKeyframe*>& stored,
                                   std::vector<int>& covered) {
  dropDepth(keyframe);
  auto free = std::find(used_.begin(), used_.end(), false);
  if (free == used_.end()) {
    // Depth maps of another map, or of culled keyframes, are in nobody's way but ours.
    StoredKeyframe* least = nullptr;
    std::size_t least_place = stored.size();
    float least_loss = std::numeric_limits<float>::max();
    for (StoredKeyframe& slot : slots_) {
      if (slot.depth == nullptr) continue;
      const auto place =
          static_cast<std::size_t>(std::find(stored.begin(), stored.end(), &slot) - stored.begin());
      float loss = -1;
      if (place < stored.size()) {
        loss = 0;
        for (std::uint32_t p : index.pointsOf(place)) loss += 1 / static_cast<float>(covered[p]);
      }
      if (loss >= least_loss) continue;
      least_loss = loss;
      least = &slot;
      least_place = place;
    }
    if (least_place < stored.size())
      for (std::uint32_t p : index.pointsOf(least_place)) --covered[p];
    dropDepth(*least);
    least->retired = true;
    free = std::find(used_.begin(), used_.end(), false);
  }
  *free = true;
  keyframe.depth = &depths_[static_cast<std::size_t>(free - used_.begin())];
  return *keyframe.depth;
}

void KeyframeStore::dropDepth(StoredKeyframe& keyframe) {
  if (keyframe.depth == nullptr) return;
  used_[static_cast<std::size_t>(keyframe.depth - depths_.data())] = false;
  keyframe.depth = nullptr;
}

}  // namespace depthscope::recon
