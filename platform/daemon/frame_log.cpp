#include "platform/daemon/frame_log.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cinttypes>
#include <cstring>

#include "types/error.hpp"

namespace depthscope::platform {
namespace {

long long microseconds(FrameTimes::Time from, FrameTimes::Time to) {
  return std::chrono::duration_cast<std::chrono::microseconds>(to - from).count();
}

}  // namespace

FrameLog::FrameLog(const std::string& path) {
  // Not even a pipe that nobody reads from may hold the start up.
  const int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK;
  if (const int fd = ::open(path.c_str(), flags, 0666); fd >= 0) file_.reset(::fdopen(fd, "w"));
  if (!file_)
    throw InputError("daemon.frame_log: " + path + ": cannot be written: " + std::strerror(errno));
  std::fputs(
      "sequence,captured_us,dequeued_us,uploaded_us,overlaid_us,composited_us,submitted_us,"
      "overlay_status,overlay_age_ms,damaged,shown_us\n",
      file_.get());
}

void FrameLog::add(const FrameTimes& times) {
  const std::uint64_t n = added_.load(std::memory_order_relaxed);
  if (n - written_.load(std::memory_order_acquire) >= capacity) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  ring_[n % capacity] = times;
  added_.store(n + 1, std::memory_order_release);
}

void FrameLog::flush() {
  const std::uint64_t end = added_.load(std::memory_order_acquire);
  for (std::uint64_t n = written_.load(std::memory_order_relaxed); n < end; ++n) {
    const FrameTimes& t = ring_[n % capacity];
    std::fprintf(file_.get(), "%" PRIu64 ",%lld,%lld,%lld,%lld,%lld,%lld,%d,", t.sequence,
                 microseconds({}, t.captured), microseconds(t.captured, t.dequeued),
                 microseconds(t.captured, t.uploaded), microseconds(t.captured, t.overlaid),
                 microseconds(t.captured, t.composited), microseconds(t.captured, t.submitted),
                 t.overlay_status);
    if (t.overlay_age_ms) std::fprintf(file_.get(), "%.2f", static_cast<double>(*t.overlay_age_ms));
    std::fprintf(file_.get(), ",%d,", t.damaged);
    if (t.shown) std::fprintf(file_.get(), "%lld", microseconds(t.captured, *t.shown));
    std::fputc('\n', file_.get());
  }
  written_.store(end, std::memory_order_release);
  const std::uint64_t lost = lost_.load(std::memory_order_relaxed);
  if (lost != lost_told_)
    std::fprintf(file_.get(), "# %" PRIu64 " pictures are missing here\n", lost - lost_told_);
  lost_told_ = lost;
  std::fflush(file_.get());
}

}  // namespace depthscope::platform
