#include "platform/daemon/video_thread.hpp"

#include "platform/daemon/real_time.hpp"

namespace depthscope::platform {

VideoThread::VideoThread(MakeLoop make, int priority, VideoReport& report) {
  std::promise<void> ready;
  auto is_ready = ready.get_future();
  thread_ = std::jthread([this, make = std::move(make), priority, promise = std::move(ready),
                          &report](const std::stop_token& stop) mutable {
    run(stop, make, priority, promise, report);
  });
  is_ready.get();
}

void VideoThread::run(const std::stop_token& stop, const MakeLoop& make, int priority,
                      std::promise<void>& ready, VideoReport& report) {
  std::unique_ptr<VideoLoop> loop;
  try {
    loop = make();
  } catch (...) {
    ready.set_exception(std::current_exception());
    return;
  }
  if (priority > 0) enterRealTime(priority);
  ready.set_value();
  try {
    loop->run(stop);
  } catch (...) {
    error_ = std::current_exception();
    report.ended.store(true, std::memory_order_release);
  }
}

void VideoThread::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace depthscope::platform
