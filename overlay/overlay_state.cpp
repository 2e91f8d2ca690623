#include "overlay/overlay_state.hpp"

#include <algorithm>

namespace depthscope::overlay {
namespace {

constexpr float kMinAlpha = 1.0f / 255;  // of what is worth drawing

}  // namespace

float poseAlpha(const OverlayState& state, const OverlaySettings& settings) {
  if (state.status != Status::Tracking || !state.T_camera_world.allFinite()) return 0;
  const float span = std::max(settings.full_confidence - settings.gone_confidence, 1e-3f);
  const float confidence = (state.confidence - settings.gone_confidence) / span;
  const float alpha = ageAlpha(state.age_ms, settings) * std::clamp(confidence, 0.0f, 1.0f);
  return alpha >= kMinAlpha ? alpha : 0.0f;  // not a number: 0
}

float ageAlpha(float age_ms, const OverlaySettings& settings) {
  return std::clamp(2 - 2 * age_ms / std::max(settings.max_age_ms, 1e-3f), 0.0f, 1.0f);
}

void FadeOut::apply(OverlayState& state, float max_age_ms) {
  if (state.status == Status::Tracking) {
    last_ = {state.T_camera_world, state.map_id, state.confidence, state.age_ms, state.time_s};
    return;
  }
  if (!last_ || state.time_s < 0 || last_->time_s < 0 || state.time_s < last_->time_s) return;
  const float age_ms = last_->age_ms + static_cast<float>(1e3 * (state.time_s - last_->time_s));
  if (!(age_ms <= max_age_ms)) return last_.reset();
  state.fading = true;
  state.T_camera_world = last_->T_camera_world;
  state.map_id = last_->map_id;
  state.confidence = last_->confidence;
  state.age_ms = age_ms;
}

}  // namespace depthscope::overlay
