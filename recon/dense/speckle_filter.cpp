#include "recon/dense/speckle_filter.hpp"

#include <cmath>
#include <vector>

namespace depthscope::recon {
namespace {

constexpr std::size_t kMinPatch = 60;  // [px] smaller ones go

}  // namespace

void removeSpeckles(DepthMap& map, float tolerance) {
  Grid<float>& depth = map.inverse_depth;
  std::vector<bool> seen(depth.size(), false);
  std::vector<int> patch;
  const int width = depth.width, height = depth.height;
  for (int start = 0; start < static_cast<int>(depth.size()); ++start) {
    const auto s = static_cast<std::size_t>(start);
    if (seen[s] || depth.cells[s] == 0) continue;
    patch.assign(1, start);
    seen[s] = true;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const int x = patch[next] % width, y = patch[next] / width;
      const float here = depth.at(x, y);
      const auto visit = [&](int i, int j) {
        if (i < 0 || j < 0 || i >= width || j >= height) return;
        const auto cell = static_cast<std::size_t>(j * width + i);
        const float there = depth.cells[cell];
        if (seen[cell] || there == 0 || std::abs(there - here) > tolerance) return;
        seen[cell] = true;
        patch.push_back(j * width + i);
      };
      visit(x - 1, y);
      visit(x + 1, y);
      visit(x, y - 1);
      visit(x, y + 1);
    }
    if (patch.size() >= kMinPatch) continue;
    for (int cell : patch) {
      depth.cells[static_cast<std::size_t>(cell)] = 0;
      map.confidence.cells[static_cast<std::size_t>(cell)] = 0;
    }
  }
}

}  // namespace depthscope::recon
