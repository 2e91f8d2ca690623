#include "platform/video_queue.hpp"

namespace depthscope::platform {
namespace {
constexpr std::size_t queue_length = 4;
}

VideoQueue::VideoQueue(const std::filesystem::path& path, int width, int height, double fps)
    : width_(width), height_(height), writer_(path, width, height, fps), slots_(queue_length) {
  for (Slot& slot : slots_)
    slot.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  thread_ = std::thread([this] { run(); });
}

VideoQueue::~VideoQueue() {
  stop();
}

std::span<std::uint8_t> VideoQueue::acquire(WhenFull when_full) {
  std::unique_lock lock(mutex_);
  const auto ready = [this] { return error_ || submitted_ - written_ < slots_.size(); };
  if (when_full == WhenFull::Wait) changed_.wait(lock, ready);
  if (error_) std::rethrow_exception(error_);
  if (!ready()) return {};
  return slots_[submitted_ % slots_.size()].pixels;
}

void VideoQueue::submit(std::int64_t index) {
  const std::lock_guard lock(mutex_);
  slots_[submitted_ % slots_.size()].index = index;
  ++submitted_;
  changed_.notify_all();
}

void VideoQueue::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || written_ < submitted_; });
    if (written_ == submitted_) return;
    Slot& slot = slots_[written_ % slots_.size()];
    lock.unlock();
    try {
      writer_.write({slot.pixels.data(), width_, height_, width_ * 4}, slot.index);
      lock.lock();
    } catch (...) {
      lock.lock();
      error_ = std::current_exception();
      changed_.notify_all();
      return;
    }
    ++written_;
    changed_.notify_all();
  }
}

void VideoQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void VideoQueue::finish() {
  stop();
  if (error_) std::rethrow_exception(error_);
  writer_.finish();
}

}  // namespace depthscope::platform
