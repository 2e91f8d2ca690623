#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "types/image_view.hpp"

namespace depthscope {

/// The grey level up to which a pixel may be of the dark around an endoscope's round view, `most`
/// at most: black as it is at the picture's border, and above it what the optics spill there of the
/// view's own light, measured as up to a seventh of the brightest tenth (nasal endoscopy; 24 of
/// 150). A fixed level would take dim tissue for surroundings.
inline int surroundingsLimit(const GrayView& picture, int most) {
  constexpr double kSpill = 0.15;
  using Histogram = std::array<int, 256>;
  Histogram all{}, border{};
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.row(y);
    for (int x = 0; x < picture.width; ++x) ++all[row[x]];
    if (y == 0 || y == picture.height - 1)
      for (int x = 0; x < picture.width; ++x) ++border[row[x]];
    else
      for (const int x : {0, picture.width - 1}) ++border[row[x]];
  }
  const auto percentile = [](const Histogram& histogram, int percent) {
    long total = 0, below = 0;
    for (const int n : histogram) total += n;
    int level = 0;
    while (level < 255 &&
           (below += histogram[static_cast<std::size_t>(level)]) * 100 < total * percent)
      ++level;
    return level;
  };
  const int black = percentile(border, 10), bright = percentile(all, 90);
  return std::min(most, black + static_cast<int>(kSpill * std::max(0, bright - black)));
}

}  // namespace depthscope
