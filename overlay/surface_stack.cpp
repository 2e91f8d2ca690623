#include "overlay/surface_stack.hpp"

#include <algorithm>

namespace depthscope::overlay {

void SurfaceStack::set(const SurfaceMesh& mesh, const OverlaySettings& settings) {
  newest_ = 1 - newest_;
  Surface& surface = surfaces_[newest_];
  prep_.prepare(mesh, settings, surface.prepared);
  surface.buffers.upload(surface.prepared);
  started_ = false;
}

SurfaceStack::Shown SurfaceStack::shown(std::uint32_t map_id, double time_s, float crossfade_s) {
  const Surface &newest = surfaces_[newest_], &before = surfaces_[1 - newest_];
  const auto usable = [&](const Surface& s) {
    return !s.prepared.empty() && s.prepared.map_id == map_id;
  };
  if (newest.prepared.map_id != map_id) return {usable(before) ? &before : nullptr, nullptr, 0};
  if (!started_) {
    started_ = true;
    start_s_ = time_s;
  }
  const bool timed = time_s >= 0 && start_s_ >= 0 && time_s >= start_s_ && crossfade_s > 0;
  const float crossfade =
      timed ? std::min(static_cast<float>((time_s - start_s_) / crossfade_s), 1.0f) : 1.0f;
  return {crossfade < 1 && usable(before) ? &before : nullptr, usable(newest) ? &newest : nullptr,
          crossfade};
}

}  // namespace depthscope::overlay
