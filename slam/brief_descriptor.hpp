#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "slam/descriptor.hpp"

namespace depthscope::slam {

/// Computes rotated BRIEF (Rublee et al. 2011, section 4): each bit compares two pixels of the
/// smoothed patch, the pattern turned by the keypoint's angle in steps of 2 pi / kAngleSteps.
class BriefDescriptor {
 public:
  BriefDescriptor();

  /// `centre`: the keypoint's pixel in the picture of its level smoothed once (BinomialSmoothing);
  /// the patch is smoothed once more, to a Gaussian of sigma 1 px. Reads kPatchRadius + 1 pixels
  /// around `centre`, to the right up to 31. `angle` [rad] in [-pi, pi].
  Descriptor operator()(const std::uint8_t* centre, std::ptrdiff_t stride, float angle) const;

 private:
  static constexpr int kAngleSteps = 64;
  static constexpr int kTests = 256;
  /// Places of both pixels of each test in the patch copied to rows of 32 bytes.
  using Places = std::array<std::uint16_t, 2 * static_cast<std::size_t>(kTests)>;
  std::vector<Places> turned_;  // [angle step]
};

}  // namespace depthscope::slam
