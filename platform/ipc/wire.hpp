#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "platform/label_anchor.hpp"
#include "types/label.hpp"
#include "types/tracking.hpp"
#include "types/view_outline.hpp"

namespace depthscope::platform {

// Plain data as it lies in shared memory, and its checked way back into the program's types. Flags
// and enumerators travel as integers, for any bit pattern may be read. A decode function returns
// false, and leaves its output alone, unless every value is one that an honest writer could have
// written.

inline constexpr std::size_t max_label_bytes = 64;  // with the final 0
inline constexpr std::size_t max_wire_labels = 32;

struct WirePose {
  std::int64_t frame;
  double timestamp_s;
  double R[9];  // T_camera_world, row-major
  double t[3];
  float confidence;
  std::uint32_t map_id;
  std::int32_t inliers;
  std::uint32_t state;
};

struct WireLabel {
  std::uint32_t id, map_id;
  float anchor[3];
  char text[max_label_bytes];
};
struct WireLabels {
  std::uint32_t count;
  std::array<WireLabel, max_wire_labels> labels;
};

/// The view of the scope: left and right end of every band [px], as in ViewOutline.
struct WireView {
  float ends[ViewOutline::bands][2];
};

/// How the AR process is doing. Counters only: shown, never acted upon.
struct WireArStatus {
  std::uint64_t beats;  // grows as long as the AR process lives, pictures or not
  std::int32_t keyframes, map_points, maps, lost_events, relocalizations, loops_closed;
  std::int64_t tracked_frames, dropped_frames, surfaces;
  double track_p50_ms, track_p95_ms, reconstruct_p50_ms, readout_ms;
  std::int32_t keyframe_capacity, map_point_capacity;
  std::int64_t slam_bytes;  // that these and their workspaces take, set aside at start
};

/// What the video process tells the AR process.
struct WireCommand {
  enum Kind : std::uint32_t { Reconstruct = 1, Label = 2, Reset = 3, SurfacePeriod = 4 };
  std::uint32_t kind;
  float x, y;  // Label: [px]; SurfacePeriod: x [s]
  char text[max_label_bytes];
};

WirePose encodePose(const PoseEstimate& estimate);
bool decodePose(const WirePose& wire, PoseEstimate& estimate);

/// The first `max_wire_labels` labels; longer texts are cut at a whole character.
WireLabels encodeLabels(std::span<const Label> labels);
/// `labels` keeps its capacity.
bool decodeLabels(const WireLabels& wire, std::vector<Label>& labels);

WireView encodeView(const ViewOutline& view);
bool decodeView(const WireView& wire, ViewOutline& view);

/// True unless a number in it is not finite or negative.
bool plausible(const WireArStatus& status);

WireCommand encodeCommand(WireCommand::Kind kind, const LabelRequest& label = {});
/// A new surface this often [s], 0: on demand only.
WireCommand encodeSurfacePeriod(double period_s);
/// `label` is filled for a Label; a SurfacePeriod is found in `wire.x`.
bool decodeCommand(const WireCommand& wire, WireCommand::Kind& kind, LabelRequest& label);

}  // namespace depthscope::platform
