#pragma once
#include <iosfwd>

#include "capture/v4l2_devices.hpp"
#include "platform/arguments.hpp"
#include "platform/footswitch/gpio.hpp"

namespace depthscope::platform {

/// `depthscope devices`: what capture cards there are, what they can do, and which one the daemon
/// would take. Returns the exit status; throws InputError for bad arguments or files.
int devicesCommand(Arguments arguments);

/// Prints the cards; `settings.device` empty: the choice is left out.
void printDevices(std::ostream& out, kernel::SystemCalls& calls,
                  const capture::V4l2Settings& settings);

/// Prints what a footswitch can be: keyboards, and GPIO lines that have a name.
void printPedals(std::ostream& out, kernel::SystemCalls& calls, GpioChips& chips);

}  // namespace depthscope::platform
