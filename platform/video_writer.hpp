#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>

#include "types/image_view.hpp"

namespace depthscope::platform {

/// Writes pictures to an MP4 file (MPEG-4 part 2 at high quality, an encoder that FFmpeg carries
/// itself).
class VideoWriter {
 public:
  /// Width and height [px]; an odd last column or row is left out, as the chroma is halved. Throws
  /// InputError naming the file when it cannot be made.
  VideoWriter(const std::filesystem::path& path, int width, int height, double fps);
  /// Finishes the file if finish() was not called; errors are then lost.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// Adds a picture shown at index / fps seconds; `index` must grow. Throws std::runtime_error.
  void write(const RgbaView& picture, std::int64_t index);
  /// Writes what is still buffered and the file's index. Throws std::runtime_error.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace depthscope::platform
