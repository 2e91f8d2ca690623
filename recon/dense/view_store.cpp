#include "recon/dense/view_store.hpp"

#include <algorithm>
#include <limits>

namespace depthscope::recon {

StoredView& ViewStore::claim(std::int64_t frame) {
  StoredView* chosen = &slots_.front();
  float least = std::numeric_limits<float>::max();
  for (StoredView& slot : slots_) {
    const float worth = slot.frame < 0 || slot.frame == frame ? -2 : worthOf(slot.frame);
    if (worth >= least) continue;
    least = worth;
    chosen = &slot;
  }
  dropDepth(*chosen);
  chosen->frame = -1;
  return *chosen;
}

/// Culled views are worth nothing, those that no cloud has told of yet everything.
float ViewStore::worthOf(std::int64_t frame) const {
  const auto known = std::lower_bound(worth_.begin(), worth_.end(), frame,
                                      [](const Worth& w, std::int64_t f) { return w.frame < f; });
  if (known != worth_.end() && known->frame == frame) return known->worth;
  return frame > last_cloud_frame_ ? std::numeric_limits<float>::max() / 2 : -1;
}

void ViewStore::update(const CloudIndex& index) {
  worth_.clear();
  last_cloud_frame_ = -1;
  const auto& frames = index.cloud().view_frames;
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

std::vector<StoredView*> ViewStore::inOrderOf(const SparseCloud& cloud) {
  std::vector<StoredView*> out;
  for (std::int64_t frame : cloud.view_frames) {
    const auto slot = std::find_if(slots_.begin(), slots_.end(),
                                   [&](const StoredView& s) { return s.frame == frame; });
    out.push_back(slot == slots_.end() ? nullptr : &*slot);
  }
  return out;
}

double ViewStore::worthFrom(const std::vector<StoredView*>& stored,
                            const std::vector<Pose>& T_camera_world, double depth) {
  if (std::find(used_.begin(), used_.end(), false) != used_.end()) return 0;
  return mostRedundant(stored, T_camera_world, depth).motion;
}

DepthMap& ViewStore::makeDepth(StoredView& view, const std::vector<StoredView*>& stored,
                               const std::vector<Pose>& T_camera_world, double depth) {
  dropDepth(view);
  auto free = std::find(used_.begin(), used_.end(), false);
  if (free == used_.end()) {
    dropDepth(*mostRedundant(stored, T_camera_world, depth).view);
    free = std::find(used_.begin(), used_.end(), false);
  }
  *free = true;
  view.depth = &depths_[static_cast<std::size_t>(free - used_.begin())];
  return *view.depth;
}

/// Of those with a depth map, of which there are two at least. Depth maps of another map, or of
/// frames that this one has forgotten, are in nobody's way but ours.
ViewStore::Redundant ViewStore::mostRedundant(const std::vector<StoredView*>& stored,
                                              const std::vector<Pose>& T_camera_world,
                                              double depth) {
  for (StoredView& slot : slots_)
    if (slot.depth != nullptr && std::find(stored.begin(), stored.end(), &slot) == stored.end())
      return {&slot, 0};
  std::vector<std::size_t> with_depth;
  for (std::size_t i = 0; i < stored.size(); ++i)
    if (stored[i] != nullptr && stored[i]->depth != nullptr) with_depth.push_back(i);
  Redundant most{stored[with_depth.front()], std::numeric_limits<double>::max()};
  for (std::size_t i : with_depth)
    for (std::size_t j : with_depth) {
      if (i == j) continue;
      const double motion = motionBetween(T_camera_world[i], T_camera_world[j], depth);
      if (motion < most.motion) most = {stored[i], motion};
    }
  return most;
}

void ViewStore::dropDepth(StoredView& view) {
  if (view.depth == nullptr) return;
  used_[static_cast<std::size_t>(view.depth - depths_.data())] = false;
  view.depth = nullptr;
}

}  // namespace depthscope::recon
