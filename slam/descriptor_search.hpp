#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "slam/descriptor.hpp"
#include "slam/simd_dispatch.hpp"

namespace depthscope::slam {

/// Finds, among all descriptors of a picture, the one nearest to another. Exhaustive; room for a
/// fixed number.
class DescriptorSearch {
 public:
  struct Nearest {
    int index = -1;             // the first of those equally near
    int distance = 257;         // farther than any two descriptors where there is none
    int second_distance = 257;  // of the nearest but for `index`
  };

  /// Takes up to `capacity` descriptors, below 65536.
  explicit DescriptorSearch(int capacity);

  /// What is searched from now on; copied.
  void assign(std::span<const Descriptor> descriptors);
  Nearest nearest(const Descriptor& query, SimdPath path = bestSimdPath()) const;

 private:
  // Four descriptors a block, word by word, so that a vector holds the same word of four: distances
  // need no sum across lanes.
  static constexpr int kLanes = 4;
  struct alignas(32) Block {
    std::uint64_t words[4][kLanes];
  };

  /// Distance and index of the `i`-th in one number.
  std::int32_t key(const Descriptor& query, int i) const;
  Nearest nearestPortable(const Descriptor& query) const;
  Nearest nearestAvx2(const Descriptor& query) const;

  std::vector<Block> blocks_;
  int size_ = 0;
};

}  // namespace depthscope::slam
