#pragma once

namespace depthscope::overlay {

/// sRGB and straight alpha, 0..1.
struct Color {
  float r = 1, g = 1, b = 1, a = 1;
  Color withAlpha(float alpha) const { return {r, g, b, alpha}; }
};

}  // namespace depthscope::overlay
