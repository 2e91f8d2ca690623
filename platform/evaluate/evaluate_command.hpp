#pragma once
#include "platform/arguments.hpp"

namespace depthscope::platform {

/// `depthscope evaluate SEQUENCE_DIR RUN_DIR [--plots DIR] [--json]`. Returns the exit status;
/// throws InputError for bad arguments or files.
int evaluateCommand(Arguments arguments);

}  // namespace depthscope::platform
