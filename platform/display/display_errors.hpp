#pragma once
#include "platform/display/display.hpp"

namespace depthscope::platform {

/// What an -errno of a display's device means to the user.
DisplayState displayStateOf(int error);

}  // namespace depthscope::platform
