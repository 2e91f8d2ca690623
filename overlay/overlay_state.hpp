#pragma once
#include <cstdint>
#include <string_view>

#include "overlay/overlay_settings.hpp"
#include "types/pose.hpp"

namespace depthscope::overlay {

/// What the status mark says.
enum class Status : std::uint8_t { NoAr, Initializing, Tracking, Lost, Stale, NoSignal };

/// Everything that decides how one picture is drawn over, besides surface and labels.
struct OverlayState {
  Status status = Status::NoAr;
  Pose T_camera_world;  // meaningful while status is Tracking
  std::uint32_t map_id =
      0;                 // map the pose belongs to; surface and labels of other maps are not drawn
  float confidence = 0;  // 0..1
  float age_ms = 0;  // picture's capture time minus the pose's frame's: fades towards max_age_ms
  std::string_view message;  // shown beside the mark, e.g. "damaged picture"; may be empty
  double time_s = -1;  // the picture's capture time, never falling: paces what eases from one state
                       // to the next. Negative: unknown, everything changes at once
};

/// How much of the overlay may be seen, 0..1: none without a pose one can rely on, less as the pose
/// gets old (from half of the age limit) or doubtful. What is not a number counts as nothing.
float poseAlpha(const OverlayState& state, const OverlaySettings& settings);

}  // namespace depthscope::overlay
