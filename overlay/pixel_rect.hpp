#pragma once
#include <algorithm>

namespace depthscope::overlay {

/// Rectangle of whole pixels, top left inclusive, bottom right exclusive.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  PixelRect clipped(const PixelRect& to) const {
    return {std::max(x0, to.x0), std::max(y0, to.y0), std::min(x1, to.x1), std::min(y1, to.y1)};
  }
};

}  // namespace depthscope::overlay
