#include "recon/dense/semi_global.hpp"

#include <algorithm>
#include <array>

namespace depthscope::recon {
namespace {

/// One step along a path: replaces the path costs of the last pixel by this one's and adds them to
/// its total.
template <int K>
void step(const std::uint8_t* cost, int small, int large, std::uint16_t* path,
          std::uint16_t* total) {
  constexpr std::uint16_t kHuge = 0x3fff;
  std::array<std::uint16_t, K + 2> last;
  last[0] = last[K + 1] = kHuge;
  std::uint16_t least = kHuge;
  for (int k = 0; k < K; ++k) {
    last[static_cast<std::size_t>(k + 1)] = path[k];
    least = std::min(least, path[k]);
  }
  const auto jump = static_cast<std::uint16_t>(least + large);
  const auto turn = static_cast<std::uint16_t>(small);
  for (int k = 0; k < K; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const auto beside = static_cast<std::uint16_t>(std::min(last[i], last[i + 2]) + turn);
    const std::uint16_t way = std::min(std::min(last[i + 1], beside), jump);
    path[k] = static_cast<std::uint16_t>(cost[k] + way - least);
  }
  for (int k = 0; k < K; ++k) total[k] = static_cast<std::uint16_t>(total[k] + path[k]);
}

}  // namespace

template <int K>
void SemiGlobal::aggregate(const CostVolume& volume, int small, int large, std::uint16_t* total) {
  const int width = volume.width, height = volume.height;
  const auto at = [&](int x, int y) {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x)) *
           K;
  };
  along_row_.resize(K);
  const auto sweep = [&](bool forward) {
    along_columns_.assign(static_cast<std::size_t>(width) * K, 0);
    for (int j = 0; j < height; ++j) {
      const int y = forward ? j : height - 1 - j;
      std::fill(along_row_.begin(), along_row_.end(), std::uint16_t{0});
      for (int i = 0; i < width; ++i) {
        const int x = forward ? i : width - 1 - i;
        const std::uint8_t* cost = volume.cost.data() + at(x, y);
        step<K>(cost, small, large, along_row_.data(), total + at(x, y));
        step<K>(cost, small, large, along_columns_.data() + x * K, total + at(x, y));
      }
    }
  };
  sweep(true);
  sweep(false);
}

void SemiGlobal::run(const CostVolume& volume, int small, int large,
                     std::vector<std::uint16_t>& total) {
  total.assign(volume.cost.size(), 0);
  switch (volume.hypotheses) {
    case 4:
      return aggregate<4>(volume, small, large, total.data());
    case 8:
      return aggregate<8>(volume, small, large, total.data());
    case 16:
      return aggregate<16>(volume, small, large, total.data());
    case 32:
      return aggregate<32>(volume, small, large, total.data());
    default:
      return aggregate<64>(volume, small, large, total.data());
  }
}

}  // namespace depthscope::recon
