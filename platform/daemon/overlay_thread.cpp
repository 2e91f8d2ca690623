#include "platform/daemon/overlay_thread.hpp"

#include "platform/log.hpp"

namespace depthscope::platform {

OverlayThread::OverlayThread(MakePainter make)
    : thread_([this, make = std::move(make)] { run(make); }) {}

OverlayThread::~OverlayThread() {
  stopping_.store(true, std::memory_order_release);
  wanted_.release();
  thread_.join();
}

void OverlayThread::request(const LayerRequest& request) {
  requests_.back() = request;
  last_request_ = request.number;
  requests_.publish();
  wanted_.release();
}

const OverlayLayer* OverlayThread::newest(std::chrono::steady_clock::time_point deadline) {
  any_ |= layers_.update();
  // Without a painter (it is still being made, or cannot be) nothing will come: not worth a wait.
  while (running_.load(std::memory_order_acquire) &&
         (!any_ || layers_.front().number != last_request_) &&
         finished_.try_acquire_until(deadline))
    any_ |= layers_.update();
  return any_ ? &layers_.front() : nullptr;
}

void OverlayThread::run(const MakePainter& make) {
  try {
    const std::unique_ptr<LayerPainter> painter = make();
    running_.store(true, std::memory_order_release);
    paint(*painter);
  } catch (const std::exception& error) {
    log(LogPriority::Error, "no overlay: the picture goes on without", {{"error", error.what()}});
  }
  running_.store(false, std::memory_order_release);
}

void OverlayThread::paint(LayerPainter& painter) {
  for (;;) {
    wanted_.acquire();
    if (stopping_.load(std::memory_order_acquire)) return;
    if (!requests_.update()) continue;  // a later request was drawn for already
    painter.draw(requests_.front(), layers_.back());
    layers_.publish();
    finished_.release();
  }
}

}  // namespace depthscope::platform
