#pragma once
#include "platform/arguments.hpp"

namespace depthscope::platform {

/// Subcommands that talk to the running daemon. All take `--socket PATH`, return the exit status,
/// and throw InputError or std::runtime_error with one line for the user.
int statusCommand(Arguments arguments);
int reconstructCommand(Arguments arguments);
int overlayCommand(Arguments arguments);
int labelCommand(Arguments arguments);
int scaleCommand(Arguments arguments);
int snapshotCommand(Arguments arguments);
int exportCommand(Arguments arguments);
int resetCommand(Arguments arguments);

}  // namespace depthscope::platform
