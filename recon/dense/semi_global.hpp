#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "recon/dense/plane_sweep.hpp"

namespace depthscope::recon {

/// Semi-global matching (Hirschmueller 2008) along four directions: neighbours that differ by one
/// hypothesis cost `small`, by more `large`. Fills `total[pixel * hypotheses + k]`, the sum of the
/// four path costs. Hypotheses are counted from each pixel's own centre, so a slanted prior costs
/// nothing.
class SemiGlobal {
 public:
  void run(const CostVolume& volume, int small, int large, std::vector<std::uint16_t>& total);

 private:
  template <int K>
  void aggregate(const CostVolume& volume, int small, int large, std::uint16_t* total);

  /// Path costs of the last step along the row and along each column.
  struct Paths {
    std::vector<std::uint16_t> row, columns;
  };
  std::array<Paths, 2> paths_;
};

}  // namespace depthscope::recon
