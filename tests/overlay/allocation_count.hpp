#pragma once

namespace depthscope::overlay {

/// Allocations with operator new by this thread so far. (Mesa, written in C, has its own ways.)
long allocationCount();

}  // namespace depthscope::overlay
