#pragma once
#include <array>
#include <cstdint>

namespace depthscope::slam {

/// One test of the pattern: is the pixel at (x0, y0) darker than the one at (x1, y1)? Offsets from
/// the keypoint [px], in a disc of radius 14.5 so that they stay in the patch when turned and
/// rounded.
struct BriefTest {
  std::int8_t x0, y0, x1, y1;
};

/// The pattern of the descriptor. Changing it makes stored descriptors and vocabularies useless.
extern const std::array<BriefTest, 256> kBriefPattern;

}  // namespace depthscope::slam
