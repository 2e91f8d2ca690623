#pragma once

namespace depthscope::platform {

/// The most memory that this program has had resident so far [MB], by the kernel's high-water mark;
/// 0 where it tells none. (That of getrusage goes on from what the process was before it became
/// this program: a script, say.)
double peakResidentMb();

}  // namespace depthscope::platform
