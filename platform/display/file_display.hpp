#pragma once
#include <filesystem>

#include "platform/display/display.hpp"
#include "platform/video_queue.hpp"

namespace depthscope::platform {

/// Pictures go into a video file, as many as the encoder keeps up with; the file is complete when
/// the display is destroyed. Pictures of another size than the first mode's are left out.
class FileDisplay : public Display {
 public:
  /// Throws InputError when the file cannot be made.
  FileDisplay(const std::filesystem::path& path, int width, int height, double fps);
  ~FileDisplay() override;
  std::span<std::uint8_t> acquire(int width, int height) override;
  void present(std::int64_t index) override;
  DisplayState state() const override { return failed_ ? DisplayState::Failing : DisplayState::Ok; }

 private:
  int width_, height_;
  VideoQueue queue_;
  bool failed_ = false;
};

}  // namespace depthscope::platform
