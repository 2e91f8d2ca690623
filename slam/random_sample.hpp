#pragma once
#include <array>
#include <cstdint>
#include <random>

namespace depthscope::slam {

/// N different indices out of [0, size), size >= N. Drawn without std::uniform_int_distribution,
/// whose numbers differ between standard libraries.
template <int N>
std::array<int, N> drawSample(std::mt19937& generator, int size) {
  std::array<int, N> sample{};
  for (int i = 0; i < N; ++i) {
    bool fresh = false;
    while (!fresh) {
      sample[i] = static_cast<int>((static_cast<std::uint64_t>(generator()) * size) >> 32);
      fresh = true;
      for (int j = 0; j < i; ++j) fresh = fresh && sample[j] != sample[i];
    }
  }
  return sample;
}

}  // namespace depthscope::slam
