#pragma once
#include <string>
#include <string_view>

namespace depthscope::platform {

/// Sends one line to the daemon's control socket and returns its answer without the leading "ok ".
/// A descriptor `attached` (-1: none) goes with it. Throws InputError when no daemon answers at
/// `socket`, std::runtime_error with the daemon's words when it refuses.
std::string controlRequest(const std::string& socket, std::string_view line, int attached = -1);

}  // namespace depthscope::platform
