#include "platform/display/display.hpp"

#include "platform/display/file_display.hpp"
#include "platform/display/null_display.hpp"
#include "types/error.hpp"

namespace depthscope::platform {

std::unique_ptr<Display> makeDisplay(const DisplaySettings& settings, int width, int height,
                                     double fps) {
  if (settings.kind == DisplayKind::Null) return std::make_unique<NullDisplay>();
  if (settings.path.empty())
    throw InputError("display.path: is empty, expected a video file for display.kind = \"file\"");
  return std::make_unique<FileDisplay>(settings.path, width, height, fps);
}

}  // namespace depthscope::platform
