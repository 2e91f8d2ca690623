#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "capture/frame.hpp"

namespace depthscope::capture {

/// What a source has to say instead of, or besides, a picture. Each fault has a picture of its own
/// on the display.
enum class SourceStatus : std::uint8_t {
  Ok,           // a frame is there
  Timeout,      // nothing came within the time given
  EndOfStream,  // a clip is over
  NoDevice,
  NoCable,
  NoSignal,
  UnstableSync,
  UnsupportedMode,
  PermissionDenied,
  ReadError,
  DeviceBusy,     // another program has the card
  NoFrames,       // there is a signal, but no picture comes
  DamagedFrames,  // pictures come, but none is whole
};
inline constexpr int source_status_count = static_cast<int>(SourceStatus::DamagedFrames) + 1;

/// Short English name of a status, for logs and the status mark, e.g. "no signal".
std::string_view toString(SourceStatus status);

struct ReadResult {
  SourceStatus status = SourceStatus::Timeout;
  Frame frame;                  // not empty exactly when status is Ok
  bool format_changed = false;  // this frame's format differs from the one before
};

/// Where pictures come from: a capture card, a clip, a folder of images. Used from one thread.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next picture. Live sources hand out the newest and drop older ones; waits at most
  /// `timeout`. After start-up it never throws: faults come as a status, and reading may go on
  /// after them.
  virtual ReadResult read(std::chrono::nanoseconds timeout) = 0;
  /// Format of the next picture as far as it is known.
  virtual FrameFormat format() const = 0;
  /// Nominal rate [1/s]; 0 when unknown.
  virtual double fps() const = 0;
  /// Pictures the source itself skipped so far because newer ones were there.
  virtual std::uint64_t skipped() const = 0;
  /// One line on what was found damaged in what was read so far (concealed pictures, unreadable
  /// packets, a clip that breaks off before its announced end); empty when nothing was. A damaged
  /// clip still ends with EndOfStream, so a program asks here before it calls the clip complete.
  virtual std::string damage() const { return {}; }
  /// Pictures so far that were not handed out because they were damaged.
  virtual std::uint64_t damagedFrames() const { return 0; }
  /// What is behind the status that read() last gave, in a line for the log ("STREAMON: Device or
  /// resource busy"); may be empty. Good until the next read().
  virtual std::string_view detail() const { return {}; }
};

}  // namespace depthscope::capture
