#pragma once
#include <cstdint>
#include <vector>

#include "recon/dense/plane_sweep.hpp"

namespace depthscope::recon {

/// Semi-global matching (Hirschmueller 2008) along four directions: neighbours that differ by one
/// hypothesis cost `small`, by more `large`. Fills `total[pixel * hypotheses + k]`, the sum of the
/// four path costs. Hypotheses are counted from each pixel's own centre, so a slanted prior costs
/// nothing. `hypotheses` is 4, 8, 16, 32 or 64.
class SemiGlobal {
 public:
  void run(const CostVolume& volume, int small, int large, std::vector<std::uint16_t>& total);

 private:
  template <int K>
  void aggregate(const CostVolume& volume, int small, int large, std::uint16_t* total);

  std::vector<std::uint16_t> along_row_, along_columns_;  // path costs of the last step
};

}  // namespace depthscope::recon
