#pragma once
#include <drm.h>

#include <array>
#include <cstring>

#include "kernel/system_calls.hpp"

namespace depthscope::platform::kms {

/// Reads what a card says of finished page flips and hands each on, as `take(serial, time of the
/// vblank)`; what cannot be read, or is none, is passed over. Never waits. 0, or -ENODEV when the
/// card is gone.
template <class Take>
int readFlipEvents(kernel::SystemCalls& calls, int card, Take take) {
  using Time = kernel::SystemCalls::Time;
  alignas(drm_event_vblank) std::array<std::byte, 512> buffer;
  const ssize_t got = kernel::retryInterrupted([&] { return calls.read(card, buffer); });
  if (got == -ENODEV) return -ENODEV;
  const std::size_t end = got > 0 ? static_cast<std::size_t>(got) : 0;
  for (std::size_t at = 0; at + sizeof(drm_event) <= end;) {
    drm_event header;
    std::memcpy(&header, &buffer[at], sizeof header);
    if (header.length < sizeof header || at + header.length > end) break;
    drm_event_vblank event;
    if (header.type == DRM_EVENT_FLIP_COMPLETE && header.length >= sizeof event) {
      std::memcpy(&event, &buffer[at], sizeof event);
      take(event.user_data,
           Time(std::chrono::seconds(event.tv_sec) + std::chrono::microseconds(event.tv_usec)));
    }
    at += header.length;
  }
  return 0;
}

}  // namespace depthscope::platform::kms
