#pragma once
#include <string>

#include "platform/config/settings.hpp"

namespace depthscope::platform {

/// What a configuration read again means for a program that runs: names of keys, comma-separated.
struct SettingsChange {
  std::string applied;        // differed, and were taken over
  std::string needs_restart;  // differ, and are used at start only
};

/// Takes over into `running` the values of `fresh` that may change while the program runs (those
/// whose Setting is live).
SettingsChange adoptLiveSettings(Settings& running, Settings fresh);

}  // namespace depthscope::platform
