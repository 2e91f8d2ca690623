#pragma once
#include <string>

#include "slam/slam_system.hpp"

namespace depthscope::platform {

/// One line on what SLAM has room for and the memory that takes.
std::string capacityText(const slam::SlamSettings& settings, const slam::SlamMemory& memory);

}  // namespace depthscope::platform
