#include "slam/feature_grid.hpp"

#include <algorithm>
#include <cmath>

namespace depthscope::slam {
namespace {

constexpr float kCell = 16;  // [px]

}  // namespace

FeatureGrid::FeatureGrid(int capacity, const CameraModel& camera) {
  // The undistorted border bounds the undistorted picture; a lens that throws its corners far out
  // is cut off, since points beyond the outermost cells are kept in those.
  double min_x = 0, min_y = 0, max_x = camera.width - 1, max_y = camera.height - 1;
  const auto include = [&](double x, double y) {
    const Eigen::Vector2d u = camera.toPixel(camera.unproject({x, y}));
    min_x = std::clamp(u.x(), -1.0 * camera.width, min_x);
    max_x = std::clamp(u.x(), max_x, 2.0 * camera.width);
    min_y = std::clamp(u.y(), -1.0 * camera.height, min_y);
    max_y = std::clamp(u.y(), max_y, 2.0 * camera.height);
  };
  for (int i = 0; i <= 32; ++i) {
    const double x = (camera.width - 1) * i / 32.0, y = (camera.height - 1) * i / 32.0;
    include(x, 0);
    include(x, camera.height - 1);
    include(0, y);
    include(camera.width - 1, y);
  }
  min_x_ = static_cast<float>(min_x);
  min_y_ = static_cast<float>(min_y);
  columns_ = static_cast<int>((max_x - min_x) / kCell) + 1;
  rows_ = static_cast<int>((max_y - min_y) / kCell) + 1;
  cell_begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  entries_.reserve(capacity);
}

int FeatureGrid::column(float ux) const {
  const float c = std::floor((ux - min_x_) / kCell);
  return static_cast<int>(std::clamp(c, 0.0F, static_cast<float>(columns_ - 1)));
}

int FeatureGrid::row(float uy) const {
  const float r = std::floor((uy - min_y_) / kCell);
  return static_cast<int>(std::clamp(r, 0.0F, static_cast<float>(rows_ - 1)));
}

void FeatureGrid::build(std::span<const Keypoint> keypoints) {
  std::fill(cell_begin_.begin(), cell_begin_.end(), 0U);
  entries_.resize(keypoints.size());
  // Counting sort. Filling from the back turns each cell's end into its begin and keeps the order.
  for (const Keypoint& k : keypoints) ++cell_begin_[row(k.uy) * columns_ + column(k.ux)];
  std::uint32_t end = 0;
  for (std::uint32_t& begin : cell_begin_) begin = end += begin;
  for (std::size_t i = keypoints.size(); i-- > 0;) {
    const Keypoint& k = keypoints[i];
    entries_[--cell_begin_[row(k.uy) * columns_ + column(k.ux)]] = {
        k.ux, k.uy, static_cast<std::uint32_t>(i), k.octave};
  }
}

int FeatureGrid::query(float ux, float uy, float radius, int min_octave, int max_octave,
                       std::span<std::uint32_t> out) const {
  if (entries_.empty()) return 0;
  const int c0 = column(ux - radius), c1 = column(ux + radius);
  const int r0 = row(uy - radius), r1 = row(uy + radius);
  std::size_t count = 0;
  for (int r = r0; r <= r1; ++r) {
    // Cells of a row lie one behind the other, and so do their entries.
    const std::uint32_t end = cell_begin_[r * columns_ + c1 + 1];
    for (std::uint32_t i = cell_begin_[r * columns_ + c0]; i < end; ++i) {
      const Entry& e = entries_[i];
      const float dx = e.ux - ux, dy = e.uy - uy;
      if (dx * dx + dy * dy >= radius * radius) continue;
      if (e.octave < min_octave || e.octave > max_octave) continue;
      if (count == out.size()) return static_cast<int>(count);
      out[count++] = e.index;
    }
  }
  return static_cast<int>(count);
}

}  // namespace depthscope::slam
