#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "overlay/overlay_settings.hpp"
#include "types/pose.hpp"

namespace depthscope::overlay {

/// What the status mark says.
enum class Status : std::uint8_t { NoAr, Initializing, Tracking, Lost, Stale, NoSignal };

/// Everything that decides how one picture is drawn over, besides surface and labels.
struct OverlayState {
  Status status = Status::NoAr;
  bool fading = false;  // status is not Tracking, but the pose of a moment ago is here to fade by
  Pose T_camera_world;  // meaningful while status is Tracking, or fading
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

/// The part of it that age alone decides.
float ageAlpha(float age_ms, const OverlaySettings& settings);

/// Remembers the last pose, so that an overlay that loses it can fade by it, within the age limit,
/// instead of flashing away.
class FadeOut {
 public:
  /// For each picture's state in turn: one that has no pose gets the last one's, as old as it is by
  /// now, and is `fading`; unless that is too old by then, or a time is not known.
  void apply(OverlayState& state, float max_age_ms);
  void reset() { last_.reset(); }

 private:
  struct Last {
    Pose T_camera_world;
    std::uint32_t map_id;
    float confidence;
    float age_ms;
    double time_s;
  };
  std::optional<Last> last_;
};

}  // namespace depthscope::overlay
