#pragma once
#include <exception>
#include <functional>
#include <future>
#include <thread>

#include "platform/daemon/video_loop.hpp"

namespace depthscope::platform {

/// Runs a VideoLoop in a thread of its own, at real-time priority where permitted.
class VideoThread {
 public:
  using MakeLoop = std::function<std::unique_ptr<VideoLoop>()>;

  /// `make` runs in the new thread (graphics belong to the thread that made them). Returns when the
  /// loop is about to run; throws what `make` threw. `priority` 0: ordinary.
  VideoThread(MakeLoop make, int priority, VideoReport& report);

  /// Ends the loop and waits for it. Throws what ended it, if something did.
  void stop();

 private:
  void run(const std::stop_token& stop, const MakeLoop& make, int priority,
           std::promise<void>& ready, VideoReport& report);

  std::exception_ptr error_;
  std::jthread thread_;
};

}  // namespace depthscope::platform
