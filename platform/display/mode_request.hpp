#pragma once
#include <string>

namespace depthscope::platform {

/// The mode that the configuration asks of the monitor.
struct ModeRequest {
  int width = 0, height = 0;  // [px]; 0: chosen to fit the picture
  double refresh_hz = 0;      // 0: chosen to fit the picture

  bool automatic() const { return width == 0; }
};

/// Reads "auto", "WIDTHxHEIGHT" or "WIDTHxHEIGHT@HZ". Throws InputError that names display.mode.
ModeRequest parseModeRequest(const std::string& text);

}  // namespace depthscope::platform
