#include "capture/lockstep_source.hpp"

#include <utility>

namespace depthscope::capture {

LockstepSource::LockstepSource(const FileSourceSettings& settings, PacingClock& clock)
    : path_(settings.path), clock_(clock), player_(settings), format_(player_.format()) {}

ReadResult LockstepSource::read(std::chrono::nanoseconds) {
  if (!position_pending_ && !player_.advance()) return {SourceStatus::EndOfStream, {}, false};
  position_pending_ = false;
  const ClipPosition& position = player_.position();
  if (position.status != SourceStatus::Ok) return {position.status, {}, false};
  Frame frame = player_.acquire();
  if (frame.empty()) {
    position_pending_ = true;
    return {SourceStatus::Timeout, {}, false};
  }
  if (!player_.render(frame)) return {SourceStatus::ReadError, {}, false};
  // There is no pace to be late against, so a late picture is one that is old when it comes.
  const std::chrono::duration<double, std::milli> delay(position.delay_ms);
  frame.capture_time = clock_.now() - std::chrono::duration_cast<std::chrono::nanoseconds>(delay);
  const bool format_changed = std::exchange(format_, frame.format) != frame.format;
  return {SourceStatus::Ok, std::move(frame), format_changed};
}

}  // namespace depthscope::capture
