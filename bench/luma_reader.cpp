#include "bench/luma_reader.hpp"

#include <chrono>

#include "capture/file_source.hpp"
#include "capture/pixel_convert.hpp"

namespace depthscope::bench {

LumaReader::LumaReader(const std::filesystem::path& clip) {
  capture::FileSourceSettings settings;
  settings.path = clip;
  source_ = capture::openFileSource(settings);
}

GrayView LumaReader::next() {
  const auto result = source_->read(std::chrono::seconds(1));
  if (result.status != capture::SourceStatus::Ok) return {};
  const int width = result.frame.format.width, height = result.frame.format.height;
  gray_.resize(static_cast<std::size_t>(width) * height);
  capture::toGray(result.frame, gray_);
  return {gray_.data(), width, height, width};
}

}  // namespace depthscope::bench
