#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "capture/frame_source.hpp"

namespace depthscope::capture {

/// One entry of a fault script: from frame `first` on, for `count` frames of the clip.
struct FaultEvent {
  enum class Kind : std::uint8_t {
    SignalLost,  // read() says NoSignal for the time these frames would have taken
    Resize,      // pictures come scaled to width x height
    Late,        // each picture comes delay_ms later than its time
    Damaged,     // part of the picture is garbage and `damaged` is set
    Repeated,    // the previous picture again, under a new sequence number
  };
  Kind kind = Kind::SignalLost;
  std::int64_t first = 0;
  std::int64_t count = 1;
  int width = 0, height = 0;  // [px], Resize
  double delay_ms = 0;        // Late
};

/// Parses a fault script: one event a line, `KIND FIRST COUNT [WIDTHxHEIGHT | DELAY_MS]`, '#'
/// starts a comment; kinds as `signal-lost resize late damaged repeated`. Throws InputError naming
/// file and line.
std::vector<FaultEvent> loadFaultScript(const std::filesystem::path& path);

struct FileSourceSettings {
  std::filesystem::path path;  // video file, or folder of images in the order of their names
  enum class Pacing {
    Lockstep,
    Clip
  } pacing = Pacing::Lockstep;  // every frame at once | at the clip's own rate
  bool loop = false;            // start again at the end; sequence numbers and times go on
  double fps = 0;               // overrides the clip's rate; 0: the clip's own (image folders: 30)
  int buffers = 4;              // pool size
  std::vector<FaultEvent> faults;
};

/// Opens a clip and decodes its first picture. Under Clip pacing decoding runs ahead in its own
/// thread and frames whose time has passed are skipped in favour of the newest. Throws InputError
/// (missing, empty, truncated, not a video, no pictures in the folder, images of different sizes).
std::unique_ptr<FrameSource> openFileSource(const FileSourceSettings& settings);

/// Number of frames in the clip, where the container or the folder tells; else 0.
/// Throws like openFileSource.
std::int64_t countFrames(const std::filesystem::path& path);

}  // namespace depthscope::capture
