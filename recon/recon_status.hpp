#pragma once

namespace depthscope::recon {

enum class ReconStatus { Ok, TooFewPoints, Cancelled, OutOfMemory, Failed };

/// The status in words, for logs.
const char* toString(ReconStatus status);

}  // namespace depthscope::recon
