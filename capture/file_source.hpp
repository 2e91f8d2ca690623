#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "capture/fault_script.hpp"
#include "capture/frame_source.hpp"
#include "capture/pacing_clock.hpp"

namespace depthscope::capture {

struct FileSourceSettings {
  std::filesystem::path
      path;  // video file, or folder of .png and .jpg in byte order of their names
  enum class Pacing {
    Lockstep,  // every frame, as fast as it is asked for
    Clip,      // at the clip's own rate, from the first read() on
  } pacing = Pacing::Lockstep;
  bool loop = false;  // start again at the end; sequence numbers and media times go on
  double fps = 0;     // [1/s] overrides the clip's rate, up to 1000; 0: the clip's own (else 30)
  int buffers = 4;    // pool size, 2 to 64
  std::vector<FaultEvent> faults{};
};

/// Opens a clip and decodes its first picture. Throws InputError (missing, empty, truncated, not a
/// video, no pictures in the folder, images of different sizes).
///
/// Frame i, counted from 0 over all passes of a loop, has sequence i and media_time_s i / fps.
/// Pictures in Yuv420p, Nv12, Gray8, Rgb24 and Bgr24 are handed on as decoded, others are converted
/// to Gray8, Rgb24 or Yuv420p, whichever is nearest. Clips that do not say their matrix are read as
/// BT.709 above 576 lines and BT.601 below, as players do.
///
/// Lockstep: read() decodes in the caller's thread; capture_time is the time of the call. The
/// timeout has no meaning; Timeout is returned, and nothing lost, while the caller holds all
/// buffers. Clip: a thread decodes ahead; read() hands out the newest picture whose time has come,
/// or waits for the next. capture_time is the picture's time by `clock`, which must outlive the
/// source. Pictures for which no buffer is free at their time are skipped, as a capture card would.
///
/// A position that cannot be shown has a status in place of a picture, and its sequence number is
/// used up: ReadError (an image that does not decode), UnsupportedMode (a size other than the first
/// picture's), NoSignal (by script). Packets of a video that decode to nothing leave no gap. Either
/// way damage() tells, and so it does when the clip breaks off before its announced end.
std::unique_ptr<FrameSource> openFileSource(const FileSourceSettings& settings,
                                            PacingClock& clock = PacingClock::steady());

/// The pictures of a folder that make its clip, frame by frame: .png, .jpg and .jpeg in byte order
/// of their names, hidden files passed over. Throws InputError when there are none.
std::vector<std::filesystem::path> listPictures(const std::filesystem::path& folder);

/// Number of frames in the clip, where the container or the folder tells; else 0.
/// Throws InputError like openFileSource, but decodes nothing.
std::int64_t countFrames(const std::filesystem::path& path);

}  // namespace depthscope::capture
