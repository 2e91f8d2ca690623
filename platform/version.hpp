#pragma once

namespace depthscope::platform {

/// Version of the programs, set by the build.
inline constexpr const char* version = DEPTHSCOPE_VERSION;

}  // namespace depthscope::platform
