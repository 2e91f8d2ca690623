#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "capture/frame.hpp"
#include "kernel/system_calls.hpp"
#include "platform/config/settings.hpp"
#include "platform/display/dma_picture.hpp"

namespace depthscope::platform {

/// Whether pictures get out, and if not, why.
enum class DisplayState : std::uint8_t {
  Ok,
  Starting,          // nothing was shown yet
  NoDevice,          // there is no such card or framebuffer
  NoMonitor,         // the card has no connected monitor
  PermissionDenied,  // the device may not be opened, or another program holds it
  Unsupported,       // the device lacks what is needed
  Failing,           // the device answers with errors
};

/// Short English name of a state, for the status and the log, e.g. "no monitor".
std::string_view toString(DisplayState state);

/// What the monitor runs at; zeros where nothing is known.
struct DisplayMode {
  int width = 0, height = 0;  // [px]
  double refresh_hz = 0;
};

/// A picture that reached the monitor.
struct ShownPicture {
  using Time = std::chrono::steady_clock::time_point;
  std::int64_t index = 0;  // as given to present()
  Time submitted{};        // handed to the driver
  Time shown{};            // the vblank from which on it was scanned out
};

/// Where finished pictures go: a monitor, a file, nowhere. Used from one thread. No fault of a
/// display is an exception: the state says what is wrong, and the display goes on trying by itself
/// each time it is used.
class Display {
 public:
  virtual ~Display() = default;
  /// A buffer of height * width * 4 bytes (R G B A) for the next picture, in ordinary memory; empty
  /// when it cannot be shown now (no monitor, a fault, not this size) and is to be given up.
  virtual std::span<std::uint8_t> acquire(int width, int height) = 0;
  /// Shows the picture in the buffer last acquired; `index` grows with time, one each nominal frame
  /// time. When an earlier picture still waits for its turn, the newer one takes its place.
  virtual void present(std::int64_t index) = 0;
  /// Whether it is worth asking presentFrame() for this picture.
  virtual bool takesFrame(const capture::Frame& /*frame*/) const { return false; }
  /// Shows a captured picture with a layer over it, where the hardware can put the two together;
  /// after acquire() and in place of present(). The display then keeps the frame until another
  /// picture has taken its place, and tells where: good until the next call. Null with the frame
  /// left as it was: the picture is to be composed. Null with the frame gone: the display has just
  /// failed.
  virtual const capture::Frame* presentFrame(capture::Frame& /*frame*/, const LayerView& /*layer*/,
                                             std::int64_t /*index*/) {
    return nullptr;
  }
  virtual DisplayState state() const = 0;
  virtual DisplayMode mode() const { return {}; }
  /// The next picture that is known to have been shown, oldest first; none where the display does
  /// not know. Those that nobody takes are forgotten.
  virtual std::optional<ShownPicture> takeShown() { return std::nullopt; }
};

/// The display that the settings ask for. `calls` outlives it. Throws InputError when a setting
/// makes no sense or the video file cannot be made; a device that is missing is no error here.
std::unique_ptr<Display> makeDisplay(const DisplaySettings& settings, kernel::SystemCalls& calls,
                                     int width, int height, double fps);

}  // namespace depthscope::platform
