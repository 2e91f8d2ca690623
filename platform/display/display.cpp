#include "platform/display/display.hpp"

#include "platform/display/display_errors.hpp"
#include "platform/display/fbdev/fbdev_display.hpp"
#include "platform/display/file_display.hpp"
#include "platform/display/kms/kms_display.hpp"
#include "platform/display/null_display.hpp"
#include "types/error.hpp"

namespace depthscope::platform {

std::string_view toString(DisplayState state) {
  switch (state) {
    case DisplayState::Ok:
      return "ok";
    case DisplayState::Starting:
      return "starting";
    case DisplayState::NoDevice:
      return "no device";
    case DisplayState::NoMonitor:
      return "no monitor";
    case DisplayState::PermissionDenied:
      return "permission denied";
    case DisplayState::Unsupported:
      return "unsupported";
    case DisplayState::Failing:
      return "failing";
  }
  return "unknown";
}

DisplayState displayStateOf(int error) {
  switch (error) {
    case -ENOENT:
    case -ENODEV:
    case -ENXIO:
      return DisplayState::NoDevice;
    case -EACCES:
    case -EPERM:
      return DisplayState::PermissionDenied;
    case -ENOLINK:
      return DisplayState::NoMonitor;
    case -EOPNOTSUPP:
      return DisplayState::Unsupported;
    default:
      return DisplayState::Failing;
  }
}

std::unique_ptr<Display> makeDisplay(const DisplaySettings& settings, kernel::SystemCalls& calls,
                                     int width, int height, double fps) {
  switch (settings.kind) {
    case DisplayKind::Null:
      break;
    case DisplayKind::File:
      if (settings.path.empty())
        throw InputError(
            "display.path: is empty, expected a video file for display.kind = \"file\"");
      return std::make_unique<FileDisplay>(settings.path, width, height, fps);
    case DisplayKind::Kms:
      return std::make_unique<kms::KmsDisplay>(settings, calls, fps);
    case DisplayKind::Fbdev:
      return std::make_unique<fbdev::FbdevDisplay>(settings, calls);
  }
  return std::make_unique<NullDisplay>();
}

}  // namespace depthscope::platform
