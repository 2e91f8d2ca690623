#pragma once
#include <memory>
#include <optional>

#include "capture/file_source.hpp"
#include "platform/replay/overlay_recorder.hpp"
#include "platform/replay/replay_options.hpp"
#include "platform/replay/run_record.hpp"
#include "recon/reconstructor.hpp"

namespace depthscope::platform {

/// The clip and what its file says about it.
struct ReplayClip {
  static constexpr std::int64_t unknown_frames = 216000;  // two hours at 30 fps
  std::unique_ptr<capture::FrameSource> source;
  double fps = 0;           // camera file's, else the clip's
  std::int64_t frames = 0;  // 0: not known before its end

  /// Frames to make room for.
  std::int64_t frameCapacity() const { return frames > 0 ? frames : unknown_frames; }
  double time(std::uint64_t frame) const { return static_cast<double>(frame) / fps; }
};

/// Opens the clip and checks the camera file against it. Throws InputError.
ReplayClip openReplayClip(const ReplayOptions& options);

/// The SLAM settings, with room for the whole clip's trajectory.
slam::SlamSettings slamSettings(const ReplayOptions& options, const ReplayClip& clip);

/// The next picture, or an empty frame at the clip's end. Throws InputError when the clip is
/// damaged or changes its size, std::runtime_error when the user interrupts.
capture::Frame nextFrame(const ReplayOptions& options, ReplayClip& clip);

/// At the clip's end: throws InputError when fewer pictures came than its file announced, and warns
/// when some were damaged. Closes the clip, whose memory is wanted for the results.
void finishClip(const ReplayOptions& options, ReplayClip& clip, std::int64_t frames);

/// Says what SLAM has room for, on standard output.
void printCapacity(const ReplayOptions& options, const slam::SlamSystem& slam);

/// What a replay leaves besides the video. Cloud, surface and trajectory are of the main map.
struct ReplayResult {
  RunRecord record;
  SparseCloud cloud;
  SurfaceMesh surface;
  std::vector<slam::StampedPose> trajectory;  // of the scope
  // The same relative to the tissue as it was seen; empty where there is no difference.
  std::vector<slam::StampedPose> over_tissue;
};

/// Takes cloud, trajectory and counts over from SLAM at the end, and gives `result.surface` its
/// last version: of the whole main map where it can be reconstructed, else the one it had, if of
/// that map; none without a `reconstructor` (may be null).
void takeFinalMap(const slam::SlamSystem& slam, recon::Reconstructor* reconstructor,
                  ReplayResult& result);

/// Measures the scale that was asked for, if one was, on the last surface and by the corrected pose
/// of its picture. Warns where it cannot be.
void takeScale(const ReplayOptions& options, ReplayResult& result);

/// Reconstructs `cloud` into `mesh` and records the time, that of the pictures since the last
/// surface included; false, and `mesh` as it was, when there is no surface.
bool reconstruct(recon::Reconstructor& reconstructor, const SparseCloud& cloud, SurfaceMesh& mesh,
                 RunMetrics& metrics);

/// Tracks every frame, maps before the next one, reconstructs every period and at the end: the same
/// clip gives the same result. `recorder` may be null.
ReplayResult replayLockstep(const ReplayOptions& options, ReplayClip& clip,
                            OverlayRecorder* recorder);

/// Plays at the clip's rate with tracking, mapping and reconstruction in threads of their own; late
/// frames are dropped. `recorder` may be null.
ReplayResult replayRealtime(const ReplayOptions& options, ReplayClip& clip,
                            OverlayRecorder* recorder);

}  // namespace depthscope::platform
