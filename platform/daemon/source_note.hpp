#pragma once
#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "capture/frame_source.hpp"

namespace depthscope::platform {

/// What the video loop has to say about its source, for the log: the newest only. The loop never
/// waits and does not allocate.
class SourceNote {
 public:
  struct Text {
    capture::SourceStatus status = capture::SourceStatus::Ok;
    std::string detail;
  };

  /// False when the other side is just reading: to be said again.
  bool put(capture::SourceStatus status, std::string_view detail) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return false;
    status_ = status;
    length_ = std::min(detail.size(), text_.size());
    std::copy_n(detail.begin(), length_, text_.begin());
    fresh_ = true;
    return true;
  }
  std::optional<Text> take() {
    const std::lock_guard lock(mutex_);
    if (!fresh_) return std::nullopt;
    fresh_ = false;
    return Text{status_, {text_.data(), length_}};
  }

 private:
  std::mutex mutex_;
  bool fresh_ = false;
  capture::SourceStatus status_ = capture::SourceStatus::Ok;
  std::array<char, 240> text_{};
  std::size_t length_ = 0;
};

}  // namespace depthscope::platform
