#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "platform/config/settings.hpp"

namespace depthscope::platform {

/// Where finished pictures go: a monitor, a file, nowhere. Used from one thread.
class Display {
 public:
  virtual ~Display() = default;
  /// A buffer of height * width * 4 bytes (R G B A) for the next picture; empty when it cannot be
  /// shown (the display is busy, or does not do this size) and is to be given up.
  virtual std::span<std::uint8_t> acquire(int width, int height) = 0;
  /// Shows the picture in the buffer last acquired; `index` grows with time, one each nominal frame
  /// time. Does not throw: a display that fails says so in failed().
  virtual void present(std::int64_t index) = 0;
  /// Whether pictures no longer get out.
  virtual bool failed() const = 0;
};

/// The display that the settings ask for. Throws InputError when it cannot be had.
std::unique_ptr<Display> makeDisplay(const DisplaySettings& settings, int width, int height,
                                     double fps);

}  // namespace depthscope::platform
