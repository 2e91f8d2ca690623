#include "overlay/overlay_state.hpp"

#include <algorithm>

namespace depthscope::overlay {
namespace {

constexpr float kMinAlpha = 1.0f / 255;  // of what is worth drawing

}  // namespace

float poseAlpha(const OverlayState& state, const OverlaySettings& settings) {
  if (state.status != Status::Tracking || !state.T_camera_world.allFinite()) return 0;
  const float age = 2 - 2 * state.age_ms / std::max(settings.max_age_ms, 1e-3f);
  const float span = std::max(settings.full_confidence - settings.gone_confidence, 1e-3f);
  const float confidence = (state.confidence - settings.gone_confidence) / span;
  const float alpha = std::clamp(age, 0.0f, 1.0f) * std::clamp(confidence, 0.0f, 1.0f);
  return alpha >= kMinAlpha ? alpha : 0.0f;  // not a number: 0
}

}  // namespace depthscope::overlay
