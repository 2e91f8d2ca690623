#pragma once
#include <atomic>
#include <cstdint>

namespace depthscope::platform {

/// What the video loop tells the rest of the daemon, word by word, without a lock.
struct VideoReport {
  std::atomic<std::uint64_t> loops{0};   // turns of the loop: its heartbeat
  std::atomic<std::uint64_t> frames{0};  // pictures shown
  std::atomic<std::uint64_t> skipped{
      0};  // pictures that the source gave up because newer ones were there
  std::atomic<std::uint64_t> given_up{0};  // pictures that the display did not take
  std::atomic<std::uint64_t> faults{0};    // fault pictures shown
  std::atomic<std::uint64_t> rejected{
      0};  // things from the AR process that did not pass the checks
  std::atomic<std::uint64_t> overlay_failures{
      0};  // pictures shown without overlay: the graphics driver failed
  std::atomic<std::uint64_t> tracked{0};        // pictures shown with a fresh pose
  std::atomic<std::uint8_t> source_status{0};   // capture::SourceStatus
  std::atomic<std::uint8_t> overlay_status{0};  // overlay::Status
  std::atomic<double> composite_p50_ms{0}, composite_p99_ms{0};
  std::atomic<bool> ended{false};  // the clip is over
};

}  // namespace depthscope::platform
