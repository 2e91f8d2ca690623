#include "overlay/blend.hpp"

#include <algorithm>
#include <cstring>

namespace depthscope::overlay {
namespace {

constexpr int kBlock = 8;  // pixels looked at together

std::uint8_t over(unsigned layer, unsigned picture, unsigned transparency) {
  const unsigned t = picture * transparency + 128;  // rounded division by 255, exact for bytes
  return static_cast<std::uint8_t>(std::min(layer + ((t + (t >> 8)) >> 8), 255u));
}

void blendPixel(const std::uint8_t* layer, const std::uint8_t* picture, std::uint8_t* out) {
  const unsigned transparency = 255u - layer[3];
  // Drivers round colours and alpha apart: a trace of colour without alpha is not part of the
  // layer.
  const unsigned present = layer[3] == 0 ? 0u : 255u;
  for (int c = 0; c < 3; ++c) out[c] = over(layer[c] & present, picture[c], transparency);
  out[3] = picture[3];
}

}  // namespace

void blendRow(const std::uint8_t* layer, const std::uint8_t* picture, std::uint8_t* out,
              int pixels) {
  std::uint64_t words[kBlock / 2];
  int i = 0;
  for (; i + kBlock <= pixels;
       i += kBlock, layer += 4 * kBlock, picture += 4 * kBlock, out += 4 * kBlock) {
    std::memcpy(words, layer, sizeof words);
    if ((words[0] | words[1] | words[2] | words[3]) == 0) {
      if (out != picture) std::memcpy(out, picture, 4 * kBlock);
      continue;
    }
    for (int p = 0; p < kBlock; ++p) blendPixel(layer + 4 * p, picture + 4 * p, out + 4 * p);
  }
  for (; i < pixels; ++i, layer += 4, picture += 4, out += 4) blendPixel(layer, picture, out);
}

void blendLayerPixel(const std::uint8_t* above, std::uint8_t* layer) {
  const unsigned transparency = 255u - above[3];
  for (int c = 0; c < 4; ++c) layer[c] = over(above[c], layer[c], transparency);
}

}  // namespace depthscope::overlay
