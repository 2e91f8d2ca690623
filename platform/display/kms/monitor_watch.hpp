#pragma once
#include "platform/display/kms/card.hpp"

namespace depthscope::platform::kms {

enum class Connection : std::uint8_t { Connected, Disconnected, Unknown };

/// Where sysfs says whether a monitor is plugged in.
std::string statusPath(const Card& card, const Connector& connector);

/// What the kernel last knew of a connector: no monitor is asked and no lock of the driver taken,
/// so that a real-time loop may read it. Does not allocate.
Connection connection(kernel::SystemCalls& calls, const std::string& status_path);

/// Whether the kernel knows of a monitor on a connector of this name ("auto": on any) of the card
/// (empty: of any), or cannot say.
bool monitorSeen(kernel::SystemCalls& calls, const std::string& card, const std::string& connector);

/// Asks the card for the connector of this name, or ("auto") for the first that has a monitor. 0 or
/// -errno; -ENOLINK: no monitor there.
int findMonitor(const Card& card, const std::string& wanted, Connector& out);

}  // namespace depthscope::platform::kms
