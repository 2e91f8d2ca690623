#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "slam/simd_dispatch.hpp"

// The FAST-9/16 score (Rosten & Drummond 2006), for one pixel or for a vector of neighbours at
// once. Internal to the FAST detector and the refinement of its corners.
namespace depthscope::slam::fast {

// Every function here is inlined: how vectors are passed by value does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

using Byte = std::uint8_t;
/// 16 or 32 pixels side by side, worked on together.
using Bytes16 = Byte __attribute__((vector_size(16)));
using Bytes32 = Byte __attribute__((vector_size(32)));

// Each for one pixel or for a vector of them.
template <class V>
DEPTHSCOPE_KERNEL void load(const Byte* from, V& to) {
  std::memcpy(&to, from, sizeof(V));
}
template <class V>
DEPTHSCOPE_KERNEL V lower(const V& a, const V& b) {
  return a < b ? a : b;
}
template <class V>
DEPTHSCOPE_KERNEL V upper(const V& a, const V& b) {
  return a > b ? a : b;
}
/// a - b, but not below 0.
template <class V>
DEPTHSCOPE_KERNEL V excess(const V& a, const V& b) {
  return static_cast<V>(upper(a, b) - b);
}

/// Offsets of the 16 pixels of the circle, in order around it.
DEPTHSCOPE_KERNEL std::array<std::ptrdiff_t, 16> circleOffsets(std::ptrdiff_t stride) {
  constexpr std::array<int, 16> kX{0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  constexpr std::array<int, 16> kY{-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  std::array<std::ptrdiff_t, 16> offsets{};
  for (int k = 0; k < 16; ++k) offsets[k] = kY[k] * stride + kX[k];
  return offsets;
}

/// The score at `p`. The two arcs of nine that share the eight pixels k+1..k+8 are taken together:
/// best of (min8, end k) and (min8, end k+9) = min(min8, max(ends)).
template <class V>
DEPTHSCOPE_KERNEL void scoreAt(const Byte* p, const std::array<std::ptrdiff_t, 16>& offsets,
                               V& score) {
  V ring[16], low2[8], high2[8], low4[8], high4[8], centre;
  load(p, centre);
#pragma GCC unroll 16
  for (int k = 0; k < 16; ++k) load(p + offsets[k], ring[k]);
  for (int i = 0; i < 8; ++i) {
    low2[i] = lower(ring[2 * i + 1], ring[(2 * i + 2) % 16]);
    high2[i] = upper(ring[2 * i + 1], ring[(2 * i + 2) % 16]);
  }
  for (int i = 0; i < 8; ++i) {
    low4[i] = lower(low2[i], low2[(i + 1) % 8]);
    high4[i] = upper(high2[i], high2[(i + 1) % 8]);
  }
  V brightest = centre, darkest = centre;  // so that neither difference is below zero
  for (int i = 0; i < 8; ++i) {
    const V &a = ring[2 * i], &b = ring[(2 * i + 9) % 16];
    brightest = upper(brightest, lower(lower(low4[i], low4[(i + 2) % 8]), upper(a, b)));
    darkest = lower(darkest, upper(upper(high4[i], high4[(i + 2) % 8]), lower(a, b)));
  }
  score = upper(static_cast<V>(brightest - centre), static_cast<V>(centre - darkest));
}

}  // namespace depthscope::slam::fast
