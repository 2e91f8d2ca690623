#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace depthscope::platform {

/// A picture of one 16-bit channel, rows packed.
struct Gray16Picture {
  int width = 0, height = 0;  // [px]
  std::vector<std::uint16_t> pixels;

  std::uint16_t at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

/// Reads a 16-bit grey PNG, its values as they are. Throws InputError naming the file when it
/// cannot be read or is another kind of picture.
Gray16Picture readGray16Png(const std::filesystem::path& path);

}  // namespace depthscope::platform
