#pragma once
#include <filesystem>
#include <string>

namespace depthscope::platform {

/// The whole of a small file. Throws InputError naming the file, and `expected`, when it cannot be
/// read.
std::string readTextFile(const std::filesystem::path& path, const char* expected);

}  // namespace depthscope::platform
