#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>

#include "capture/frame.hpp"

namespace depthscope::capture {

/// A folder of its own, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Value of byte `x` of row `y` in plane `plane` of frame `frame`.
using Pattern = std::function<std::uint8_t(int frame, int plane, int x, int y)>;

/// A pattern that differs from frame to frame, plane to plane and pixel to pixel.
std::uint8_t gradient(int frame, int plane, int x, int y);

/// A lossless video (Matroska; FFV1 for YUV and gray, raw for RGB) of `frames` pictures.
void writeVideo(const std::filesystem::path& path, const FrameFormat& format, int frames, int fps,
                const Pattern& pattern);
/// Frame `frame` of the pattern as .png (Gray8, Rgb24) or .jpg (Yuv420p), by the name.
void writePicture(const std::filesystem::path& path, const FrameFormat& format, int frame,
                  const Pattern& pattern);
/// The first `bytes` of `path` written to `to`.
void truncateFile(const std::filesystem::path& path, const std::filesystem::path& to,
                  std::size_t bytes);

}  // namespace depthscope::capture
