#pragma once
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "platform/video_writer.hpp"

namespace depthscope::platform {

/// A VideoWriter in a thread of its own behind a few preallocated pictures, so that encoding runs
/// beside compositing. Used from one thread: acquire a buffer, fill it, submit it.
class VideoQueue {
 public:
  /// Throws like VideoWriter.
  VideoQueue(const std::filesystem::path& path, int width, int height, double fps);
  ~VideoQueue();

  enum class WhenFull { Wait, GiveUp };
  /// A buffer of height * width * 4 bytes (R G B A) to fill, or an empty span when all are waiting
  /// to be encoded and the caller does not want to wait. Throws what the encoder threw, if it did.
  std::span<std::uint8_t> acquire(WhenFull when_full);
  /// Hands over the buffer last acquired, to be shown at index / fps seconds.
  void submit(std::int64_t index);
  /// Encodes all that was submitted and closes the file. Throws std::runtime_error.
  void finish();

 private:
  struct Slot {
    std::vector<std::uint8_t> pixels;
    std::int64_t index = 0;
  };
  void run();
  void stop();

  int width_, height_;
  VideoWriter writer_;
  std::vector<Slot> slots_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t submitted_ = 0, written_ = 0;  // slot of picture n: n % slots
  bool stopping_ = false;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace depthscope::platform
