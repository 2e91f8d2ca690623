#pragma once
#include <atomic>
#include <cstdint>

#include "platform/daemon/frame_clock.hpp"
#include "platform/daemon/source_note.hpp"
#include "platform/display/display.hpp"
#include "platform/ipc/seqlock.hpp"

namespace depthscope::platform {

/// What the video loop tells the rest of the daemon, word by word, without a lock.
struct VideoReport {
  std::atomic<std::uint64_t> presented{0};  // pictures and fault pictures given to the display:
                                            // what the watchdog lives on
  std::atomic<std::uint64_t> display_faults{
      0};  // turns in which the display said why it shows nothing: a restart would not help it
  std::atomic<std::uint64_t> frames{0};  // pictures shown
  std::atomic<std::uint64_t> skipped{
      0};  // pictures that the source gave up because newer ones were there
  std::atomic<std::uint64_t> damaged{0};   // pictures not shown because they were damaged
  std::atomic<std::uint64_t> given_up{0};  // pictures that the display did not take
  std::atomic<std::uint64_t> faults{0};    // fault pictures shown
  std::atomic<std::uint64_t> rejected{
      0};  // things from the AR process that did not pass the checks
  std::atomic<std::uint64_t> overlay_failures{
      0};  // pictures shown without overlay: the graphics driver failed
  std::atomic<std::uint64_t> tracked{0};                 // pictures shown with a fresh pose
  std::atomic<std::uint8_t> source_status{0};            // capture::SourceStatus
  std::atomic<std::uint8_t> overlay_status{0};           // overlay::Status
  std::atomic<std::uint8_t> display_state{0};            // DisplayState
  std::atomic<int> display_width{0}, display_height{0};  // [px] of the monitor's mode
  std::atomic<double> display_refresh_hz{0};
  std::atomic<std::uint64_t> stale{0};  // old pictures shown again, marked as such
  std::atomic<std::uint64_t> late_overlays{
      0};                               // pictures shown with an overlay drawn for one before
  SeqlockBox<FrameClockSummary> times;  // brought up to date every second or so
  std::atomic<bool> ended{false};       // the clip is over
  SourceNote source_note;

  /// Takes over how the display is doing. From the video loop.
  void note(const Display& display);
};

}  // namespace depthscope::platform
