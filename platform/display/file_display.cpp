#include "platform/display/file_display.hpp"

#include "platform/log.hpp"

namespace depthscope::platform {

FileDisplay::FileDisplay(const std::filesystem::path& path, int width, int height, double fps)
    : width_(width), height_(height), queue_(path, width, height, fps) {}

FileDisplay::~FileDisplay() {
  try {
    if (!failed_) queue_.finish();
  } catch (const std::exception& error) {
    log(LogPriority::Error, "video file cannot be finished", {{"error", error.what()}});
  }
}

std::span<std::uint8_t> FileDisplay::acquire(int width, int height) {
  if (failed_ || width != width_ || height != height_) return {};
  try {
    return queue_.acquire(VideoQueue::WhenFull::GiveUp);
  } catch (const std::exception& error) {
    failed_ = true;
    log(LogPriority::Error, "video file cannot be written", {{"error", error.what()}});
    return {};
  }
}

void FileDisplay::present(std::int64_t index) {
  queue_.submit(index);
}

}  // namespace depthscope::platform
