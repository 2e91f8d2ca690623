#pragma once
#include "platform/config/settings.hpp"
#include "platform/unique_fd.hpp"

namespace depthscope::platform {

/// A configuration file in memory that sets every key, sealed: what one process was configured
/// with, handed to another, whatever happens to the file on the disk meanwhile. Throws
/// std::system_error.
UniqueFd makeSettingsFile(const Settings& settings);

}  // namespace depthscope::platform
