#pragma once

namespace depthscope::platform {

/// From now on SIGINT and SIGTERM only set a flag, so that work under way can be cleaned up.
void catchInterrupts();
/// Whether one of them came.
bool interrupted();

}  // namespace depthscope::platform
