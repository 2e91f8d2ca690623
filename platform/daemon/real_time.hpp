#pragma once

namespace depthscope::platform {

/// Gives the calling thread SCHED_FIFO at this priority; processes and threads that it makes start
/// at the ordinary one. False, after a warning, where that is not permitted.
bool enterRealTime(int priority);

/// Keeps all pages of the process, present and future, in memory once they were touched. False,
/// after a warning, where that is not permitted.
bool lockMemory();

}  // namespace depthscope::platform
