#include "platform/daemon/video_report.hpp"

namespace depthscope::platform {

void VideoReport::note(const Display& display) {
  const DisplayState state = display.state();
  const DisplayMode mode = display.mode();
  display_state.store(static_cast<std::uint8_t>(state), std::memory_order_relaxed);
  if (state != DisplayState::Ok && state != DisplayState::Starting)
    display_faults.fetch_add(1, std::memory_order_release);
  display_width.store(mode.width, std::memory_order_relaxed);
  display_height.store(mode.height, std::memory_order_relaxed);
  display_refresh_hz.store(mode.refresh_hz, std::memory_order_relaxed);
}

}  // namespace depthscope::platform
