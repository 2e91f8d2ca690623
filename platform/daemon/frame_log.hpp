#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "platform/daemon/frame_clock.hpp"

namespace depthscope::platform {

/// A line for every picture, in a CSV file: times in microseconds after its capture, the last one
/// (when it was on the glass) empty where the display does not tell or passed it over. The video
/// loop puts records into a ring; another thread writes them out, so that no disk holds up a
/// picture.
class FrameLog {
 public:
  /// Throws InputError when the file cannot be made.
  explicit FrameLog(const std::string& path);

  /// From the video loop. A full ring loses the record, and the file says how many.
  void add(const FrameTimes& times);
  /// From the writing thread: writes what has come since.
  void flush();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  static constexpr std::size_t capacity = 1024;  // 17 s at 60 pictures a second

  std::unique_ptr<std::FILE, Close> file_;
  std::array<FrameTimes, capacity> ring_;
  std::atomic<std::uint64_t> added_{0}, written_{0}, lost_{0};
  std::uint64_t lost_told_ = 0;
};

}  // namespace depthscope::platform
