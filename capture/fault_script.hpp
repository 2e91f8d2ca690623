#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace depthscope::capture {

/// One entry of a fault script: from frame `first` of the clip on, for `count` frames. Frames are
/// counted from 0 within the clip, so that a looped clip acts out its faults in every pass.
struct FaultEvent {
  enum class Kind : std::uint8_t {
    SignalLost,  // read() says NoSignal, once for each of these frames at the time it would have
                 // come
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
/// starts a comment; kinds as `signal-lost resize late damaged repeated`. Sides are 16 to 16384
/// pixels, delays up to 60000 ms. Throws InputError naming file and line.
std::vector<FaultEvent> loadFaultScript(const std::filesystem::path& path);

/// What a script does to one frame of the clip. Events may overlap; a later line wins over an
/// earlier one of its kind.
struct FrameFaults {
  bool signal_lost = false;
  bool damaged = false;
  bool repeated = false;
  double delay_ms = 0;
  const FaultEvent* resize = nullptr;  // an element of the script
};
FrameFaults faultsAt(std::span<const FaultEvent> script, std::int64_t frame);

}  // namespace depthscope::capture
