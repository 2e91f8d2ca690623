#pragma once
#include <cstdint>

namespace depthscope::overlay {

/// Lays `pixels` premultiplied RGBA pixels of `layer` over the same number of `picture`, in `out`:
/// out = layer + (1 - alpha) picture, saturated. Where the layer's alpha is 0 `out` is the
/// picture, bit for bit; the picture's own alpha is kept everywhere. `out` may be `picture`, but
/// not overlap it otherwise.
void blendRow(const std::uint8_t* layer, const std::uint8_t* picture, std::uint8_t* out,
              int pixels);

/// Lays one premultiplied pixel over another, alpha included.
void blendLayerPixel(const std::uint8_t* above, std::uint8_t* layer);

}  // namespace depthscope::overlay
