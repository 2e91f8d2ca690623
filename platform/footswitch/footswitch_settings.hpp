#pragma once
#include <string>

#include "platform/footswitch/gpio.hpp"

namespace depthscope::platform {

enum class FootswitchAction : std::uint8_t { Reconstruct, OverlayToggle, Snapshot };

/// The surgeon's pedal: a switch on a GPIO line, or a USB pedal that is a keyboard, or both.
struct FootswitchSettings {
  FootswitchAction action = FootswitchAction::Reconstruct;
  std::string line;  // GPIO line by name, or with `chip` by its offset; empty: none
  std::string chip;  // path, name or label; empty: the line is looked for by name on all chips
  GpioBias bias = GpioBias::AsIs;
  bool active_low = false;
  double debounce_ms = 20;  // a switch of a pedal bounces for a few milliseconds
  std::string keyboard;     // path under /dev/input or name of the device; empty: none
  int key = 0;              // its key, by its number in linux/input-event-codes.h; 0: any
};

}  // namespace depthscope::platform
