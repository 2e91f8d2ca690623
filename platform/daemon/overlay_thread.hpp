#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <semaphore>
#include <thread>

#include "platform/daemon/layer_painter.hpp"
#include "platform/daemon/layer_source.hpp"
#include "platform/triple_buffer.hpp"

namespace depthscope::platform {

/// Draws overlays in a thread of its own, so that the picture waits neither for the graphics driver
/// nor for what the AR process sends. A driver that fails or hangs costs the overlay, nothing else.
class OverlayThread final : public LayerSource {
 public:
  using MakePainter = std::function<std::unique_ptr<LayerPainter>()>;

  /// Returns at once; `make` runs in the new thread, for graphics belong to the thread that made
  /// them. Where it throws, the reason is logged and there will be no layers.
  explicit OverlayThread(MakePainter make);
  ~OverlayThread() override;
  OverlayThread(const OverlayThread&) = delete;
  OverlayThread& operator=(const OverlayThread&) = delete;

  void request(const LayerRequest& request) override;
  const OverlayLayer* newest(std::chrono::steady_clock::time_point deadline) override;

 private:
  void run(const MakePainter& make);
  void paint(LayerPainter& painter);

  TripleBuffer<LayerRequest> requests_;
  TripleBuffer<OverlayLayer> layers_;
  std::counting_semaphore<> wanted_{0}, finished_{0};
  std::atomic<bool> stopping_{false}, running_{false};
  std::uint64_t last_request_ = 0;
  bool any_ = false;
  std::thread thread_;  // last: it uses what stands above
};

}  // namespace depthscope::platform
