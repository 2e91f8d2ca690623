#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "capture/frame_source.hpp"
#include "types/image_view.hpp"

namespace depthscope::bench {

/// The pictures of a clip as luma, one after the other.
class LumaReader {
 public:
  /// Throws InputError when the clip cannot be read.
  explicit LumaReader(const std::filesystem::path& clip);
  /// The next picture, valid until the next call; empty at the end.
  GrayView next();

 private:
  std::unique_ptr<capture::FrameSource> source_;
  std::vector<std::uint8_t> gray_;
};

}  // namespace depthscope::bench
