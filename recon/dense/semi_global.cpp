#include "recon/dense/semi_global.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace depthscope::recon {
namespace {

constexpr std::uint16_t kHuge = 0x3fff;

/// Eight path costs.
typedef std::uint16_t Eight __attribute__((vector_size(16)));
typedef std::uint8_t EightBytes __attribute__((vector_size(8)));

Eight least(const Eight& a, const Eight& b) {
  return a < b ? a : b;
}

template <class T>
T load(const void* from) {
  T v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

/// Path costs after a pixel of cost `cost`, of those before it: `before` and `after` are the same
/// moved by one hypothesis, `best` is the least of them.
Eight next(const Eight& last, const Eight& before, const Eight& after, const Eight& best,
           const Eight& cost, std::uint16_t small, std::uint16_t large) {
  const Eight beside = least(before, after) + small;
  return cost + least(least(last, beside), best + large) - best;
}

/// One step along a row and a column at once: replaces the path costs of the last pixels by this
/// one's and adds them to its total.
template <int K>
void step(const std::uint8_t* cost, int small, int large, std::uint16_t* row, std::uint16_t* column,
          std::uint16_t* total) {
  for (std::uint16_t* path : {row, column}) {
    std::array<std::uint16_t, K + 2> last;
    last[0] = last[K + 1] = kHuge;
    std::uint16_t best = kHuge;
    for (int k = 0; k < K; ++k) {
      last[static_cast<std::size_t>(k + 1)] = path[k];
      best = std::min(best, path[k]);
    }
    const auto jump = static_cast<std::uint16_t>(best + large);
    const auto turn = static_cast<std::uint16_t>(small);
    for (int k = 0; k < K; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const auto beside = static_cast<std::uint16_t>(std::min(last[i], last[i + 2]) + turn);
      const std::uint16_t way = std::min(std::min(last[i + 1], beside), jump);
      path[k] = static_cast<std::uint16_t>(cost[k] + way - best);
    }
    for (int k = 0; k < K; ++k) total[k] = static_cast<std::uint16_t>(total[k] + path[k]);
  }
}

/// The costs of both paths side by side in one vector.
template <>
void step<4>(const std::uint8_t* cost, int small, int large, std::uint16_t* row,
             std::uint16_t* column, std::uint16_t* total) {
  const auto r = load<std::uint64_t>(row), c = load<std::uint64_t>(column);
  const auto four = static_cast<std::uint64_t>(load<std::uint32_t>(cost));
  const std::array<std::uint64_t, 2> both{r, c};
  const auto last = load<Eight>(both.data());
  const Eight huge = Eight{} + kHuge;
  Eight best = least(last, __builtin_shufflevector(last, last, 1, 0, 3, 2, 5, 4, 7, 6));
  best = least(best, __builtin_shufflevector(best, best, 2, 3, 0, 1, 6, 7, 4, 5));
  const std::uint64_t twice = four | four << 32;
  const Eight path = next(last, __builtin_shufflevector(last, huge, 8, 0, 1, 2, 8, 4, 5, 6),
                          __builtin_shufflevector(last, huge, 1, 2, 3, 8, 5, 6, 7, 8), best,
                          __builtin_convertvector(load<EightBytes>(&twice), Eight),
                          static_cast<std::uint16_t>(small), static_cast<std::uint16_t>(large));
  const auto out = load<std::array<std::uint64_t, 2>>(&path);
  std::memcpy(row, &out[0], 8);
  std::memcpy(column, &out[1], 8);
  // No sum of path costs overflows its 16 bits into the next.
  const std::uint64_t sum = load<std::uint64_t>(total) + out[0] + out[1];
  std::memcpy(total, &sum, 8);
}

template <>
void step<8>(const std::uint8_t* cost, int small, int large, std::uint16_t* row,
             std::uint16_t* column, std::uint16_t* total) {
  const Eight costs = __builtin_convertvector(load<EightBytes>(cost), Eight);
  const Eight huge = Eight{} + kHuge;
  auto sum = load<Eight>(total);
  for (std::uint16_t* to : {row, column}) {
    const auto last = load<Eight>(to);
    Eight best = least(last, __builtin_shufflevector(last, last, 1, 0, 3, 2, 5, 4, 7, 6));
    best = least(best, __builtin_shufflevector(best, best, 2, 3, 0, 1, 6, 7, 4, 5));
    best = least(best, __builtin_shufflevector(best, best, 4, 5, 6, 7, 0, 1, 2, 3));
    const Eight path =
        next(last, __builtin_shufflevector(last, huge, 8, 0, 1, 2, 3, 4, 5, 6),
             __builtin_shufflevector(last, huge, 1, 2, 3, 4, 5, 6, 7, 8), best, costs,
             static_cast<std::uint16_t>(small), static_cast<std::uint16_t>(large));
    std::memcpy(to, &path, sizeof path);
    sum += path;
  }
  std::memcpy(total, &sum, sizeof sum);
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
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  // From the first pixel on and from the last one back, step by step in turns: neither waits for
  // what the other has just worked out.
  for (Paths& paths : paths_) paths.columns.assign(static_cast<std::size_t>(width) * K, 0);
  for (int y = 0; y < height; ++y) {
    for (Paths& paths : paths_) paths.row.assign(K, 0);
    for (int x = 0; x < width; ++x) {
      const std::size_t there = at(x, y), back = (pixels - 1) * K - there;
      step<K>(volume.cost.data() + there, small, large, paths_[0].row.data(),
              paths_[0].columns.data() + x * K, total + there);
      step<K>(volume.cost.data() + back, small, large, paths_[1].row.data(),
              paths_[1].columns.data() + (width - 1 - x) * K, total + back);
    }
  }
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
