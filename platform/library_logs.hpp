#pragma once

namespace depthscope::platform {

/// Keeps FFmpeg from writing to stderr by itself: errors reach the user as one line of ours.
void silenceLibraries();

}  // namespace depthscope::platform
