#pragma once
#include <iosfwd>

#include "kernel/system_calls.hpp"
#include "platform/config/settings.hpp"

namespace depthscope::platform {

/// The graphics cards, their connectors and modes, and which of them the daemon would light for a
/// picture of this size and rate (0: not known). Changes nothing.
void printDisplays(std::ostream& out, kernel::SystemCalls& calls, const DisplaySettings& settings,
                   int width, int height, double fps);

}  // namespace depthscope::platform
