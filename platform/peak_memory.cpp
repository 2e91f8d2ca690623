#include "platform/peak_memory.hpp"

#include <cstdlib>
#include <fstream>
#include <string>

namespace depthscope::platform {

double peakResidentMb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtod(line.c_str() + 6, nullptr) / 1024.0;
  return 0;
}

}  // namespace depthscope::platform
