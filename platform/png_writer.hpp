#pragma once
#include <filesystem>

#include "types/image_view.hpp"

namespace depthscope::platform {

/// Writes a picture as an RGB PNG (the alpha is left out). Throws std::runtime_error naming the
/// file.
void writePng(const std::filesystem::path& path, const RgbaView& picture);

}  // namespace depthscope::platform
