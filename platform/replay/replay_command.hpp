#pragma once
#include "platform/arguments.hpp"

namespace depthscope::platform {

/// `depthscope replay`: returns the exit status 0; throws InputError for bad arguments or files and
/// std::exception for a failure of the program, after which nothing it wrote is left.
int replayCommand(Arguments arguments);

}  // namespace depthscope::platform
