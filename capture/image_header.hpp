#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>

namespace depthscope::capture {

enum class ImageKind : std::uint8_t { Png, Jpeg };

struct ImageHeader {
  ImageKind kind = ImageKind::Png;
  int width = 0, height = 0;  // [px]
};

/// Kind and size from the first bytes of a PNG or JPEG file, whatever its name says, without
/// decoding it; nothing when it is neither or breaks off before its size is known.
std::optional<ImageHeader> readImageHeader(const std::filesystem::path& path);

}  // namespace depthscope::capture
