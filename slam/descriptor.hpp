#pragma once
#include <array>
#include <bit>
#include <cstdint>

namespace depthscope::slam {

/// 256-bit rotated BRIEF (Rublee et al. 2011); bit i is test i of the pattern, least significant
/// first.
struct Descriptor {
  std::array<std::uint64_t, 4> bits{};
  bool operator==(const Descriptor&) const = default;
};

/// Number of differing bits, 0..256.
inline int hammingDistance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (int i = 0; i < 4; ++i) distance += std::popcount(a.bits[i] ^ b.bits[i]);
  return distance;
}

}  // namespace depthscope::slam
