#pragma once

namespace depthscope::capture {

/// Calls of operator new in this program so far.
int allocationCount();

}  // namespace depthscope::capture
